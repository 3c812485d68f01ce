// SPDX-License-Identifier: MIT
// The world that a simulated lidar measures: straight walls, and the position of the lidar.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "g4lidar/detail/api.hpp"

namespace g4lidar::sim {

/// A wall from one point to the other, in metres, seen from above: x to the right, y up.
struct wall {
  double x1_m;
  double y1_m;
  double x2_m;
  double y2_m;
};

/// The position of a lidar and the direction of its angle 0: degrees counter-clockwise from the x
/// axis. The lidar's own angles grow clockwise from there.
struct pose {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_deg = 0.0;
};

/// Walls and the position of the lidar. A world that is filled by a program must meet the rules of
/// parse_world() for files.
struct world {
  std::vector<wall> walls;
  pose lidar;
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
/// The minimum distance of a wall from the lidar.
inline constexpr double min_clearance_m = 0.01;

/// The world that `text` describes (docs/sim.md describes the format), or the first error in it.
/// Independent of the locale. Throws only std::bad_alloc.
[[nodiscard]] G4LIDAR_API std::variant<world, world_error> parse_world(std::string_view text);

}  // namespace g4lidar::sim
