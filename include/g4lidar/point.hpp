// SPDX-License-Identifier: MIT
// One corrected point, and its direction and range in the two frames of reference in use.
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <type_traits>

#include "g4lidar/angle.hpp"
#include "g4lidar/correction.hpp"

namespace g4lidar {

/// What is to be known of a point beside its numbers; a set of bits.
enum class point_marks : std::uint8_t {
  none = 0,
  no_return = 1,         ///< Nothing came back: `range_mm` is 0 and no range.
  too_near = 2,          ///< Below 100 mm, where range and correction are not to be trusted.
  revolution_start = 4,  ///< The sample of a zero packet, the first one of its revolution.
};

/// All marks of both. *Pure.*
[[nodiscard]] constexpr point_marks operator|(point_marks a, point_marks b) noexcept {
  return static_cast<point_marks>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}
/// The marks that both have. *Pure.*
[[nodiscard]] constexpr point_marks operator&(point_marks a, point_marks b) noexcept {
  return static_cast<point_marks>(static_cast<unsigned>(a) & static_cast<unsigned>(b));
}

/// Ranges below this are marked too near, in millimetres. (protocol: Point packets)
inline constexpr float too_near_mm = 100.0F;

/// One measured point in the device's own frame. Trivially copyable, 24 bytes, no padding.
struct point {
  /// The corrected direction in [0, 360), never 360: clockwise seen from above, 0 at the cable exit.
  /// Of a point without return: the first-level angle, as the manual has it; the direction in which
  /// nothing was seen is g4lidar::direction_deg().
  float angle_deg = 0.0F;
  /// The distance in millimetres, 0 for no return.
  float range_mm = 0.0F;
  /// When the point was measured, in nanoseconds of the monotonic clock; 0 where it is not known.
  std::int64_t time_ns = 0;
  /// Which revolution since the start of the stream, the first one being 0.
  std::uint32_t revolution = 0;
  point_marks marks = point_marks::none;
  /// Zeroes, so that the structure has no padding and equal points have equal bytes.
  std::array<std::uint8_t, 3> reserved{};

  /// Whether nothing came back: then `range_mm` is no range.
  [[nodiscard]] constexpr bool is_no_return() const noexcept {
    return (marks & point_marks::no_return) != point_marks::none;
  }
  /// Whether something came back from below 100 mm: there it is, but not to be trusted.
  [[nodiscard]] constexpr bool is_too_near() const noexcept {
    return (marks & point_marks::too_near) != point_marks::none;
  }
  /// Whether this is the sample of a zero packet, with which a revolution begins.
  [[nodiscard]] constexpr bool is_revolution_start() const noexcept {
    return (marks & point_marks::revolution_start) != point_marks::none;
  }

  friend constexpr bool operator==(const point&, const point&) noexcept = default;
};

static_assert(sizeof(point) == 24);
static_assert(std::is_trivially_copyable_v<point>);

/// The direction in which the sensor looked, clockwise degrees in [0, 360): `angle_deg`, but for a
/// point without return that of a target infinitely far away, 7.9906 degrees less. *Pure.*
/// (protocol: Point packets, a sample of 0)
[[nodiscard]] constexpr float direction_deg(const point& p) noexcept {
  constexpr auto far = static_cast<float>(far_correction_deg);
  return p.is_no_return() ? wrap_once_deg(p.angle_deg + far) : p.angle_deg;
}

/// The frames of reference. (protocol: Frames of reference)
enum class frame : std::uint8_t {
  /// The device's own: angles grow clockwise seen from above, 0 at the cable exit; x at 0 degrees, y
  /// at 90 degrees clockwise.
  vendor,
  /// The robot's, REP 103: angles grow counter-clockwise, x forward, y to the left; forward is
  /// opposite the cable exit. The device's frame mirrored and turned by 180 degrees.
  robot,
};

/// A direction and a range in SI units.
struct polar {
  float bearing_rad;  ///< In [-pi, pi).
  float range_m;      ///< 0 for no return.
};

/// `direction` (clockwise degrees in [0, 360), as in a point) as degrees in [0, 360) of frame `to`.
/// *Pure.*
[[nodiscard]] constexpr float bearing_deg(float direction, frame to) noexcept {
  return to == frame::robot ? wrap_once_deg(180.0F - direction) : direction;
}

/// A point's direction and range in frame `to`. *Pure.*
[[nodiscard]] constexpr polar to_polar(const point& p, frame to) noexcept {
  const float turned = bearing_deg(direction_deg(p), to);
  const float centred = turned >= 180.0F ? turned - 360.0F : turned;
  return {centred * (std::numbers::pi_v<float> / 180.0F), p.range_mm * 0.001F};
}

}  // namespace g4lidar
