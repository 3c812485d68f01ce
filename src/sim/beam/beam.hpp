// SPDX-License-Identifier: MIT
// The curved beam of a lidar, and where it meets one wall or one disc.
#pragma once

#include <cstdint>
#include <optional>

#include "g4lidar/core/angle.hpp"
#include "g4lidar/sim/ray_caster.hpp"
#include "sim/arithmetic.hpp"

namespace g4lidar::sim {

inline constexpr double least_range_mm = 1.0;  // nearer targets are not seen

/// A beam, and its direction in the lidar's frame (see seen_wall), a unit vector.
struct beam {
  double e_x, e_y;
  beam_shape shape;
};
[[nodiscard]] inline beam beam_at(double first_level_deg, const beam_shape& shape) noexcept {
  const sin_cos direction = sin_cos_deg(first_level_deg);
  return {direction.cosine, direction.sine, shape};
}

/// A disc in millimetres in the lidar's frame.
struct seen_disc {
  double x, y;  // of its centre
  double radius;
};

/// `heading` is that of `viewpoint`.
[[nodiscard]] G4LIDAR_HIDDEN seen_wall as_seen(const wall& w, const pose& viewpoint,
                                               const sin_cos& heading,
                                               std::uint32_t index) noexcept;

/// The least range at which the beam meets the target, if that is not beyond.
[[nodiscard]] G4LIDAR_HIDDEN std::optional<double> meet(const seen_wall& target, const beam& ray,
                                                        double not_beyond_mm) noexcept;
[[nodiscard]] G4LIDAR_HIDDEN std::optional<double> meet(const seen_disc& target, const beam& ray,
                                                        double not_beyond_mm) noexcept;

/// The order in which walls are tried. The index makes it the same with every standard library.
[[nodiscard]] inline bool is_tried_before(const seen_wall& a, const seen_wall& b) noexcept {
  return a.nearest < b.nearest || (a.nearest == b.nearest && a.index < b.index);
}

/// The first wall on a beam, of walls in that order.
class wall_search {
 public:
  wall_search(double first_level_deg, const beam_shape& shape) noexcept
      : first_level_deg_(first_level_deg), ray_(beam_at(first_level_deg, shape)) {}

  /// Returns false if neither this wall nor a later one can be the first.
  bool take(const seen_wall& candidate) noexcept {
    if (candidate.nearest > best_) return false;
    const std::optional<double> range = meet(candidate, ray_, best_);
    if (range) {
      best_ = *range;
      wall_ = candidate.index;
    }
    return true;
  }
  [[nodiscard]] std::optional<sighting> found() const noexcept {
    if (!wall_) return std::nullopt;
    return sighting{best_, wrap_once_deg(first_level_deg_ + correction_deg(best_, ray_.shape)),
                    *wall_};
  }

 private:
  double first_level_deg_;
  beam ray_;
  double best_ = 1e9;
  std::optional<std::uint32_t> wall_;
};

}  // namespace g4lidar::sim
