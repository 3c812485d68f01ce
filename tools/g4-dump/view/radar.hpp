// SPDX-License-Identifier: MIT
// Draws a revolution on a canvas, seen from above: rings with their ranges, and the returns.
#pragma once

#include <cstdint>
#include <span>

#include "canvas.hpp"
#include "g4lidar/cartesian.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"

namespace g4_tool {

/// The visible area. Up is ahead in the robot frame, and 0 degrees in the vendor frame.
struct radar_view {
  g4lidar::frame frame = g4lidar::frame::robot;
  double range_m = 8.0;  ///< From the middle to the nearest edge.
  bool grid = true;
  std::uint16_t turn_deg = g4lidar::g4_model.turn_deg;  ///< Of the lidar's model.
  bool is_map = false;       ///< The picture is in the map, with x up: `robot` is not its middle.
  g4lidar::pose_2d robot{};  ///< In the picture, in metres from its middle.
  std::span<const g4lidar::xy_point>
      traces{};  ///< Earlier returns and the way driven, in the picture.
};

/// The zoom range that shows nearly all returns; 16 m if there are none.
[[nodiscard]] double range_for(std::span<const g4lidar::point> points) noexcept;
/// The next smaller or larger zoom range; the last one stays.
[[nodiscard]] double next_range(double range_m, bool farther) noexcept;

void draw_radar(canvas& canvas, const cell_area& area, std::span<const g4lidar::point> points,
                const radar_view& view);

}  // namespace g4_tool
