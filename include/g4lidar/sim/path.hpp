// SPDX-License-Identifier: MIT
// The path of a simulated robot: timed poses, and a smooth curve between them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "g4lidar/detail/api.hpp"

namespace g4lidar::sim {

/// The position of a lidar or a robot, and the direction of its angle 0: degrees counter-clockwise
/// from the x axis. The angles of a lidar grow clockwise from there.
struct pose {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_deg = 0.0;

  friend constexpr bool operator==(const pose&, const pose&) noexcept = default;
};

/// A pose, and how fast it changes: metres and degrees per second along the axes of the world.
struct moving_pose {
  pose at;
  pose per_s;

  friend constexpr bool operator==(const moving_pose&, const moving_pose&) noexcept = default;
};

/// Where a robot is at a time. The heading is not wrapped: 370 after 350 is a turn of 20 degrees.
struct path_point {
  std::int64_t time_ns;
  moving_pose robot;
};

/// The maximum number of points of a path.
inline constexpr std::size_t max_path_points = 100'000;
/// The last possible time of a path.
inline constexpr std::int64_t max_path_ns = 1'000'000'000'000'000;
/// The maximum of the mean speed between two points.
inline constexpr double max_speed_m_per_s = 20.0;
/// The same for the turning.
inline constexpr double max_turn_deg_per_s = 1000.0;

/// Sets the speeds of all points: a curve through the poses that passes none of them, and is at rest
/// at both ends and where it turns back. Times ascending. *Pure.*
G4LIDAR_API void smooth(std::span<path_point> path) noexcept;

/// Where a robot on `path`, not empty, is at a time. Between two points each coordinate is the cubic
/// polynomial that has the values and speeds of both. Before the first point and after the last one
/// it stands. *Pure.* The same bits on every processor.
[[nodiscard]] G4LIDAR_API moving_pose robot_at(std::span<const path_point> path,
                                               std::int64_t time_ns) noexcept;

/// The pose `b`, given in the frame of `a`, in the frame in which `a` is given. *Pure.*
[[nodiscard]] G4LIDAR_API pose placed(const pose& a, const pose& b) noexcept;

/// The pose of a lidar's angle 0 (the cable's exit), if `looks` is the pose of its frame in REP 103
/// (frame::robot), whose x axis points away from the cable. *Pure.*
[[nodiscard]] constexpr pose cable_pose(const pose& looks) noexcept {
  return {looks.x_m, looks.y_m, looks.heading_deg + (looks.heading_deg > 0.0 ? -180.0 : 180.0)};
}

}  // namespace g4lidar::sim
