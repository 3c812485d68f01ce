// SPDX-License-Identifier: MIT
// What the beam of a lidar hits: rays that are curved by the inverse of the second-level correction; where the lidar and
// discs may move, too.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/sim/world.hpp"

namespace g4lidar::sim {

/// The limit of the correction of a G4 for far targets, in degrees.
inline constexpr double far_correction_deg = -7.990596267964585603;

/// The curve of a beam: the correction of a target at d mm is the angle whose tangent is
/// offset_mm / d - slope.
struct beam_shape {
  double offset_mm;      ///< k: of the laser from the axis.
  double slope;          ///< c: the beam crosses the centre line at offset_mm / slope, if not 0.
  double inflection_mm;  ///< The range at which its curvature changes its sign.
  double far_deg;        ///< The limit of the correction for far targets, in degrees.
};

/// No change of the curvature.
inline constexpr double no_inflection_mm = 1e12;
/// Of a G4 and most others: it crosses the centre line at 155.3 mm.
inline constexpr beam_shape triangle_beam{21.8, 21.8 / 155.3, 232.7808551523369427,
                                          far_correction_deg};
/// Of an SCL, whose laser is parallel to the centre line.
inline constexpr beam_shape scl_beam{17.8, 0.0, no_inflection_mm, 0.0};
/// Of a lidar that measures the time of flight: no correction.
inline constexpr beam_shape straight_beam{0.0, 0.0, no_inflection_mm, 0.0};

/// The second-level correction of a target at `range_mm` > 0, in degrees, in double precision and
/// written independently of the core. *Pure.* (protocol: Point packets, second-level correction)
[[nodiscard]] G4LIDAR_API double correction_deg(double range_mm,
                                                const beam_shape& shape = triangle_beam) noexcept;

/// A wall in millimetres in the lidar's frame: x at bearing 0, y at bearing 90.
struct seen_wall {
  double normal_x;      ///< Of the unit vector from the lidar to the line of the wall.
  double normal_y;      ///< The same.
  double tangent_x;     ///< Of the unit vector along the wall.
  double tangent_y;     ///< The same.
  double distance;      ///< Of the line of the wall, >= 0.
  double along_begin;   ///< Where the wall begins on its line.
  double along_end;     ///< Where it ends.
  double nearest;       ///< The distance of its nearest point.
  double farthest;      ///< The distance of its farthest point.
  std::uint32_t index;  ///< Of the wall in the world.
};

/// A target on the beam.
struct sighting {
  double range_mm;     ///< From the centre of the lidar, > 0.
  double bearing_deg;  ///< Its direction: first-level angle + correction, in [0, 360).
  std::uint32_t wall;  ///< The index of the wall that was hit; that of a disc, after all walls.
};

/// Finds the wall that the beam hits first. The correction depends on the range, so the beam is not
/// a straight line but a curve: its point at range d is at the bearing theta + correction(d).
/// Allocates on construction only; any number of threads may use a `const` caster at once.
class G4LIDAR_API ray_caster {
 public:
  /// `scene` is copied as far as needed.
  explicit ray_caster(const world& scene, const beam_shape& shape = triangle_beam);

  /// The nearest target on the beam at `first_level_deg` in [0, 360), at any distance; nothing if
  /// the beam hits no wall. Targets nearer than 1 mm are not seen.
  [[nodiscard]] std::optional<sighting> cast(double first_level_deg) const noexcept;

 private:
  beam_shape shape_;
  std::vector<seen_wall> walls_;  // the nearest first
  std::vector<std::uint32_t>
      candidates_;  // indices into walls_, sector by sector, in the order of walls_
  std::vector<std::uint32_t> sector_begin_;  // into candidates_, one more than there are sectors
};

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
