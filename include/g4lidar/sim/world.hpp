// SPDX-License-Identifier: MIT
// The world that a simulated lidar looks at: straight walls, and where the lidar stands.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "g4lidar/export.hpp"

namespace g4lidar::sim {

/// A wall from one point to the other, in metres, seen from above: x to the right, y up.
struct wall {
  double x1_m;
  double y1_m;
  double x2_m;
  double y2_m;
};

/// Where a lidar stands and which way its angle 0 points: degrees counter-clockwise from the x
/// axis. The lidar's own angles grow clockwise from there.
struct pose {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_deg = 0.0;
};

/// Walls and a lidar among them. Whoever fills one by hand keeps to what parse_world() asks of a
/// file.
struct world {
  std::vector<wall> walls;
  pose lidar;
};

/// A flat of a few rooms: a living room with oblique furniture, a pillar and a post nearer than a
/// G4 can measure; a kitchen behind an open door; a hall, the far end of which is beyond 16 m.
[[nodiscard]] G4LIDAR_API world built_in_world();

/// Why a text is not a world.
struct world_error {
  std::size_t line;     ///< Counted from 1; 0 for what is missing altogether.
  std::string message;  ///< One sentence without the line, to be shown to a person.
};

/// The most walls that a world can have.
inline constexpr std::size_t max_walls = 10'000;
/// No coordinate is further from 0 than this.
inline constexpr double max_coordinate_m = 1000.0;
/// No wall is shorter than this.
inline constexpr double min_wall_length_m = 0.001;
/// No wall comes nearer to the lidar than this.
inline constexpr double min_clearance_m = 0.01;

/// The world that `text` describes (docs/sim.md has the format), or the first error in it.
/// Independent of the locale. Throws nothing but std::bad_alloc.
[[nodiscard]] G4LIDAR_API std::variant<world, world_error> parse_world(std::string_view text);

}  // namespace g4lidar::sim
