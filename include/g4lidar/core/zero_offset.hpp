// SPDX-License-Identifier: MIT
// The offset of zero of a lidar, and the points to which it is added.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "g4lidar/point.hpp"
#include "g4lidar/settings.hpp"

namespace g4lidar {

/// What is added to each angle, as the manufacturer's program does. That this is the sign, and that a device has not
/// added it already, is an assumption: no device was at hand. *Single thread, never allocates.*
class zero_offset {
 public:
  /// Who knows it, the most reliable last.
  enum class stated_by : std::uint8_t {
    device,     ///< The lidar has answered 93.
    recording,  ///< It was used for the points that were recorded.
    user,
  };
  /// Uses it, if nobody more reliable knows another one.
  constexpr void set(zero_angle known, stated_by authority) noexcept {
    if (authority < how_) return;
    angle_ = known;
    how_ = authority;
  }
  /// Nothing as long as it is not known; then no angle is changed.
  [[nodiscard]] constexpr const std::optional<zero_angle>& angle() const noexcept { return angle_; }

  /// Adds it to the angles of `points`.
  constexpr void add_to(std::span<point> points) const noexcept {
    if (!angle_ || angle_->cdeg == 0) return;
    const auto offset_deg = static_cast<float>(angle_->deg());
    for (point& each : points) {
      float turned_deg = each.angle_deg + offset_deg;
      if (turned_deg < 0.0F) turned_deg += 360.0F;
      if (turned_deg >= 360.0F) turned_deg -= 360.0F;
      each.angle_deg = turned_deg;
    }
  }

 private:
  std::optional<zero_angle> angle_;
  stated_by how_ = stated_by::device;
};

}  // namespace g4lidar
