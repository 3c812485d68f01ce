// SPDX-License-Identifier: MIT
// One corrected point, and its direction and range in the two frames of reference in use.
#pragma once

#if __STDC_HOSTED__
#include <chrono>
#endif
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <type_traits>

#include "g4lidar/core/angle.hpp"
#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/detail/saturating.hpp"

namespace g4lidar {

/// Properties of a point; a set of bits.
enum class point_flags : std::uint8_t {
  none = 0,
  no_return = 1,  ///< Nothing came back: `range_mm` is 0 and not a range, and the way not free.
  too_near = 2,   ///< Below the model's shortest range, 100 mm for a G4: not reliable.
  revolution_start = 4,  ///< The sample of a zero packet, the first one of its revolution.
  not_deskewed = 8,      ///< deskew() left it where it was: its time or the motion is not known.
  unlikely = 16,  ///< Its packet or its neighbours contradict it; see filter/plausibility.hpp.
  isolated = 32,  ///< No other return is near; set by mark_isolated().
  veiling = 64,   ///< Between two surfaces, where nothing is; set by mark_veiling().
  may_be_too_near = 128,  ///< Without return, perhaps of something too near; set by mark_near().
};

/// All flags of both. *Pure.*
[[nodiscard]] constexpr point_flags operator|(point_flags a, point_flags b) noexcept {
  return static_cast<point_flags>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}
/// The flags that both contain. *Pure.*
[[nodiscard]] constexpr point_flags operator&(point_flags a, point_flags b) noexcept {
  return static_cast<point_flags>(static_cast<unsigned>(a) & static_cast<unsigned>(b));
}

/// The flags of `flags` that `left_out` does not contain. *Pure.*
[[nodiscard]] constexpr point_flags without(point_flags flags, point_flags left_out) noexcept {
  return static_cast<point_flags>(static_cast<unsigned>(flags) & ~static_cast<unsigned>(left_out));
}

/// One measured point in the device's own frame. Trivially copyable, 24 bytes, no padding.
struct point {
  /// The direction in which the sensor looked, in [0, 360), never 360: clockwise seen from above, 0
  /// at the cable exit. For a point without return: the direction of an infinitely distant target,
  /// 7.9906 degrees less than the first-level angle. (protocol: Point packets, no return)
  float angle_deg = 0.0F;
  /// The distance in millimetres, 0 for no return, which does not mean that the way is free.
  float range_mm = 0.0F;
  /// When the point was measured, in nanoseconds of the monotonic clock; 0 where it is not known.
  std::int64_t time_ns = 0;
  /// Which revolution since the start of the stream, the first one being 0.
  std::uint32_t revolution = 0;
  point_flags flags = point_flags::none;
  /// The flags that the sample contains, 0 to 3; 0 if the model has none. Their meaning is not known
  /// for certain, and 2 is the usual value on some models: do not filter by them unasked.
  std::uint8_t sample_flags = 0;
  /// How strong the return was, in a unit of the device; 0 if the model does not measure it. See
  /// intensity_bits().
  std::uint16_t intensity = 0;

  /// Whether nothing came back; then `range_mm` is not a range. The way is not free for it: a target
  /// that is too near gives no return either, nor does one that is too far, black, or a mirror. See
  /// filter/too_near.hpp.
  [[nodiscard]] constexpr bool is_no_return() const noexcept {
    return (flags & point_flags::no_return) != point_flags::none;
  }
  /// Whether the return came from below the shortest range of the model (100 mm for a G4): an object
  /// is there, but its range is not reliable.
  [[nodiscard]] constexpr bool is_too_near() const noexcept {
    return (flags & point_flags::too_near) != point_flags::none;
  }
  /// Whether nothing came back, perhaps because a target is nearer than the shortest range.
  [[nodiscard]] constexpr bool may_be_too_near() const noexcept {
    return (flags & point_flags::may_be_too_near) != point_flags::none;
  }
  /// Whether this is the sample of a zero packet, which begins a revolution.
  [[nodiscard]] constexpr bool is_revolution_start() const noexcept {
    return (flags & point_flags::revolution_start) != point_flags::none;
  }

  /// Whether deskew() left it where it was, because its time or the motion is not known.
  [[nodiscard]] constexpr bool is_not_deskewed() const noexcept {
    return (flags & point_flags::not_deskewed) != point_flags::none;
  }

#if __STDC_HOSTED__
  /// `time_ns` as a time of the monotonic clock; the epoch if it is not known.
  [[nodiscard]] constexpr std::chrono::steady_clock::time_point time() const noexcept {
    return std::chrono::steady_clock::time_point(std::chrono::nanoseconds(time_ns));
  }
#endif

  friend constexpr bool operator==(const point&, const point&) noexcept = default;
};

static_assert(sizeof(point) == 24);
static_assert(std::is_trivially_copyable_v<point>);

/// The first-level angle of a point, clockwise degrees in [0, 360): the angle of the head, without
/// the correction by the range, which is of this kind. *Pure.* Within 1e-4 degrees for ranges as
/// decode() gives them; g4lidar::first_level_angles has the exact angles of a packet. (protocol:
/// Point packets)
[[nodiscard]] constexpr float raw_angle_deg(const point& p,
                                            correction_kind kind = g4_format.correction) noexcept {
  const auto raw = detail::saturated<std::int32_t>(p.range_mm * 4.0F);
  switch (kind) {
    case correction_kind::triangle:
      return wrap_once_deg(p.angle_deg - compact_correction{}(raw));
    case correction_kind::scl:
      return wrap_once_deg(p.angle_deg - scl_correction{}(raw));
    case correction_kind::none:
      break;
  }
  return p.angle_deg;
}

/// The frames of reference. (protocol: Frames of reference)
enum class frame : std::uint8_t {
  /// The device's own: angles grow clockwise seen from above, 0 at the cable exit; x at 0 degrees, y
  /// at 90 degrees clockwise.
  vendor,
  /// The robot's, REP 103: angles grow counter-clockwise, x forward, y to the left. The device's
  /// frame mirrored and turned by model::turn_deg: of a G4 forward is opposite the cable exit, of a
  /// model with a turn of 0 it is 0 degrees of the device.
  robot,
};

/// A direction and a range in SI units.
struct polar {
  float bearing_rad;  ///< In [-pi, pi).
  float range_m;      ///< 0 for no return.
};

/// `direction` (clockwise degrees in [0, 360), as in a point) as degrees in [0, 360) of frame `to`.
/// `turn_deg` is that of the model, 0 or 180: in frame::robot a direction is `turn_deg` - `direction`.
/// The default is the G4's. *Pure.*
[[nodiscard]] constexpr float bearing_deg(float direction, frame to,
                                          std::uint16_t turn_deg = g4_model.turn_deg) noexcept {
  return to == frame::robot ? wrap_once_deg(static_cast<float>(turn_deg) - direction) : direction;
}

/// A point's direction and range in frame `to`; `turn_deg` as for bearing_deg(). *Pure.*
[[nodiscard]] constexpr polar to_polar(const point& p, frame to,
                                       std::uint16_t turn_deg = g4_model.turn_deg) noexcept {
  const float turned = bearing_deg(p.angle_deg, to, turn_deg);
  const float centred = turned >= 180.0F ? turned - 360.0F : turned;
  return {centred * (std::numbers::pi_v<float> / 180.0F), p.range_mm * 0.001F};
}

/// Writes all of `points` in frame `to` to the front of `out`, which is at least as long, and
/// returns what was written. *Pure.* `turn_deg` as for bearing_deg().
constexpr std::span<polar> to_polar(std::span<const point> points, frame to, std::span<polar> out,
                                    std::uint16_t turn_deg = g4_model.turn_deg) noexcept {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = to_polar(points[i], to, turn_deg);
  return out.first(points.size());
}

}  // namespace g4lidar
