// SPDX-License-Identifier: MIT
// The ranges of the LaserScan messages of a recording.
#pragma once

#include <algorithm>
#include <cstddef>
#include <new>
#include <span>
#include <vector>

#include "g4lidar/grid.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/recording/writer.hpp"
#include "g4lidar/scan.hpp"
#include "g4lidar/scan_shaper.hpp"

namespace g4lidar {

/// *Single thread.*
class scan_ranges {
 public:
  explicit scan_ranges(const recording_options& options)
      : shaper_({.marks = {.near = options.near}}) {
    const std::size_t most = options.scan_bins.value_or(
        default_bins(*std::ranges::max_element(models, {}, default_bins)));
    ranges_.reserve(most);
    intensities_.reserve(most);
  }

  /// Fills them, and sets message_header::first_bin and intensities.
  void fill(scan revolution, const recording_options& options, message_header& header) noexcept {
    const std::size_t bins = options.scan_bins.value_or(default_bins(*revolution.model));
    const std::span<const point> whole = revolution.points;
    try {
      shaper_.shape(revolution);
      revolution = shaper_.for_grid();
    } catch (const std::bad_alloc&) {
      revolution.points = whole;  // without the flags
    }
    fill_laser_scan(revolution, header, std::clamp<std::size_t>(bins, 1, ranges_.capacity()),
                    options.grid, ranges_, intensities_);
  }
  [[nodiscard]] std::span<const float> ranges_m() const noexcept { return ranges_; }

 private:
  std::vector<float> ranges_;
  std::vector<float> intensities_;
  scan_shaper shaper_;
};

}  // namespace g4lidar
