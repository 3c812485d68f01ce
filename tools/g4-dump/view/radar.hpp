// SPDX-License-Identifier: MIT
// A revolution seen from above, on a canvas: rings with their ranges, and the returns.
#pragma once

#include <span>
#include <string_view>

#include "canvas.hpp"
#include "g4lidar/point.hpp"

namespace g4_tool {

/// What of the surroundings is shown. Up is ahead in the robot frame, and 0 degrees in the vendor frame.
struct radar_view {
  g4lidar::frame frame = g4lidar::frame::robot;
  double range_m = 8.0;  ///< From the middle to the nearest edge: one of zoom_ranges().
  bool grid = true;
};

/// From near to far.
[[nodiscard]] std::span<const double> zoom_ranges() noexcept;
/// The range that shows nearly all returns; the last one if there are none.
[[nodiscard]] double range_for(std::span<const g4lidar::point> points) noexcept;
/// The next range, nearer or farther; the same at the end.
[[nodiscard]] double next_range(double range_m, bool farther) noexcept;

void draw_radar(canvas& on, const cell_area& in, std::span<const g4lidar::point> points,
                const radar_view& view);

}  // namespace g4_tool
