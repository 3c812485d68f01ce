// SPDX-License-Identifier: MIT
// The world that a simulated lidar measures: straight walls, discs that may move, and the position
// or the path of the lidar.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

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

/// A wall from one point to the other, in metres, seen from above: x to the right, y up.
struct wall {
  double x1_m;
  double y1_m;
  double x2_m;
  double y2_m;
};

/// A round thing: a pillar, or a person who walks back and forth between two places on a straight way
/// at a constant speed, from (x_m, y_m) at time 0. It stands if the speed is 0.
struct disc {
  double radius_m;
  double x_m;
  double y_m;
  double to_x_m = 0.0;
  double to_y_m = 0.0;
  double speed_m_per_s = 0.0;
};

/// Walls, discs, and a robot with a lidar. A world that is filled by a program must meet the rules
/// of parse_world() for files.
struct world {
  std::vector<wall> walls;
  /// Where the robot stands. With the default `mounted_at` the lidar itself, its angle 0 ahead.
  pose lidar;
  std::vector<disc> discs{};
  /// How the robot moves, times ascending; empty: it stands at `lidar`.
  std::vector<path_point> path{};
  /// The lidar's frame (frame::robot: it looks along x) in that of the robot: x forward, y to the left;
  /// the meaning of mounting::pose. By default the cable points ahead.
  pose mounted_at{0.0, 0.0, 180.0};
};

/// A flat with several rooms: a living room with oblique furniture, a pillar, and a post nearer
/// than a G4 can measure; a kitchen behind an open door; a hall that ends beyond 16 m.
[[nodiscard]] G4LIDAR_API world built_in_world();

/// Why a text is not a world.
struct world_error {
  std::size_t line;     ///< Counted from 1; 0 if a required statement is missing.
  std::string message;  ///< One sentence without the line number, for people.
};

/// The maximum number of walls in a world.
inline constexpr std::size_t max_walls = 10'000;
/// The maximum of each coordinate, in magnitude.
inline constexpr double max_coordinate_m = 1000.0;
/// The minimum length of a wall.
inline constexpr double min_wall_length_m = 0.001;
/// The minimum distance of a wall from the lidar at time 0.
inline constexpr double min_clearance_m = 0.01;
/// The maximum number of discs in a world.
inline constexpr std::size_t max_discs = 1'000;
/// The minimum radius of a disc.
inline constexpr double min_disc_radius_m = 0.01;
/// The maximum radius of a disc.
inline constexpr double max_disc_radius_m = 2.0;
/// The maximum speed of a disc.
inline constexpr double max_disc_speed_m_per_s = 10.0;

/// The world that `text` describes (docs/sim.md describes the format), or the first error in it.
/// Independent of the locale. Throws only std::bad_alloc.
[[nodiscard]] G4LIDAR_API std::variant<world, world_error> parse_world(std::string_view text);

/// The path that `text` describes, lines `pose` or `drive` as in a world, or the first error in it.
/// Commands begin at `start`. Independent of the locale. Throws only std::bad_alloc.
[[nodiscard]] G4LIDAR_API std::variant<std::vector<path_point>, world_error> parse_path(
    std::string_view text, const pose& start);

}  // namespace g4lidar::sim
