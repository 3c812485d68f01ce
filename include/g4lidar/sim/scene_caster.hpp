// SPDX-License-Identifier: MIT
// What a lidar that may move sees in a world where discs may move.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/sim/ray_caster.hpp"
#include "g4lidar/sim/world.hpp"

namespace g4lidar::sim {

/// Finds the first target on the beam of a lidar at its pose of that time. With a fixed lidar a
/// ray_caster finds the walls; otherwise all walls are tried. Both give the same bits for the same
/// pose. *Single thread. Allocates on construction only.* A copy is independent.
class G4LIDAR_API scene_caster {
 public:
  /// Copies what it needs of the world. `is_turned`: angle 0 is opposite to where the lidar looks.
  explicit scene_caster(const world& scene, const beam_shape& shape = triangle_beam,
                        bool is_turned = true);

  /// The pose of the lidar. The heading is not wrapped.
  [[nodiscard]] pose lidar_at(std::int64_t time_ns) const noexcept;
  /// As ray_caster::cast(), at a time, with the lidar at its pose of that time. `is_mirrored`: the world
  /// is mirrored at the lidar's own axis of angle 0.
  [[nodiscard]] std::optional<sighting> cast(double first_level_deg, const pose& lidar,
                                             std::int64_t time_ns, bool is_mirrored) noexcept;

 private:
  struct walk {
    disc what;
    double rounds_per_s;  // to the other place and back; 0: it stands
  };
  struct way_of_beam;

  [[nodiscard]] G4LIDAR_HIDDEN std::optional<sighting> cast_at_walls(
      double first_level_deg, const way_of_beam& beam) noexcept;

  beam_shape shape_;
  std::vector<path_point> path_;
  pose zero_;   // of the angle 0, in the frame of the robot
  pose fixed_;  // of the lidar, without a path
  ray_caster caster_;
  ray_caster mirrored_caster_;
  std::vector<wall> walls_;           // for a lidar that moves
  std::vector<seen_wall> near_beam_;  // room for all of them
  std::vector<walk> discs_;
  std::uint32_t first_disc_;  // the index of a sighting
};

}  // namespace g4lidar::sim
