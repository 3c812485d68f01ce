// SPDX-License-Identifier: MIT
// A scan that Python keeps: its points are a NumPy array.
#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <span>

#include "arrays.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/scan.hpp"

namespace g4lidar::python {

/// The only copy of the points is the array.
struct kept_scan {
  explicit kept_scan(const scan& scan, std::int64_t wall_minus_monotonic_ns);

  scan about;            ///< Without points.
  array<point> points;   ///< The points.
  std::int64_t time_ns;  ///< Of the first point.
  std::int64_t end_ns;   ///< When the next scan began.
  std::int64_t wall_ahead_ns;
  float measured_sample_rate_hz;
  float measured_frequency_hz;
};

/// Points in frame `to`, two columns; `turn_deg` is that of the model.
[[nodiscard]] array<float> to_xy_array(const array<point>& points, frame to,
                                       std::uint16_t turn_deg);
/// One range for each bin, in metres. `intensities` is empty, or gets that of each bin.
[[nodiscard]] array<float> to_ranges(const array<point>& points, std::size_t bins,
                                     const grid_options& options,
                                     std::span<float> intensities = {});

/// Raises ValueError if numbers are not finite, or times do not ascend.
void require_path(std::span<const stamped_pose> path);

void bind_scan(nb::module_& module);
void bind_shaping(nb::module_& module);
void bind_filters(nb::module_& module);

}  // namespace g4lidar::python
