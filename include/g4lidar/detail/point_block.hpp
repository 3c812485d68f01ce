// SPDX-License-Identifier: MIT
// Up to 64 points as arrays, moved from one place of the lidar to another one by vector instructions.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>

#include "g4lidar/core/angle.hpp"
#include "g4lidar/core/correction.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar::detail {

// Here poses are in the lidar's own frame (frame::vendor): x at 0 degrees, y at 90 degrees, and yaw as the angles of
// the points grow. So the arithmetic is the same for a lidar that hangs with its top down.

/// From frame::robot of a lidar to its frame::vendor: the factors of x, y and yaw, 1 or -1.
/// (protocol: Frames of reference)
class vendor_axes {
 public:
  /// `turn_deg` is that of the model, 0 or 180.
  constexpr vendor_axes(bool upside_down, std::uint16_t turn_deg) noexcept
      : x_(turn_deg == 0 ? 1.0 : -1.0), yaw_(upside_down ? 1.0 : -1.0) {}

  /// *Pure.*
  [[nodiscard]] constexpr pose_2d operator()(const pose_2d& pose) const noexcept {
    return {x_ * pose.x_m, x_ * yaw_ * pose.y_m, yaw_ * pose.yaw_rad};
  }
  /// The same for a twist.
  [[nodiscard]] constexpr twist_2d operator()(const twist_2d& twist) const noexcept {
    return {x_ * twist.x_m_per_s, x_ * yaw_ * twist.y_m_per_s, yaw_ * twist.yaw_rad_per_s};
  }

 private:
  double x_;
  double yaw_;
};

/// `a` where `mask` has all bits set, `b` where it has none. *Pure.*
[[nodiscard]] constexpr float chosen(std::uint32_t mask, float a, float b) noexcept {
  return std::bit_cast<float>((std::bit_cast<std::uint32_t>(a) & mask) |
                              (std::bit_cast<std::uint32_t>(b) & ~mask));
}

/// The square root of a number that is not negative, within 2e-7 of itself, without libm. *Pure.* (std::sqrt sets errno,
/// so that a loop over it is not vectorized.)
[[nodiscard]] constexpr float square_root(float square) noexcept {
  // A first guess of the reciprocal root by halving the exponent, two steps by Newton, and one for the root itself.
  float reciprocal =
      std::bit_cast<float>(0x5F37'5A86U - (std::bit_cast<std::uint32_t>(square) >> 1));
  const float half = 0.5F * square;
  reciprocal *= 1.5F - half * reciprocal * reciprocal;
  reciprocal *= 1.5F - half * reciprocal * reciprocal;
  const float root = square * reciprocal;
  return root + 0.5F * reciprocal * (square - root * root);
}

/// The direction from x towards y of a place, in degrees in [-180, 180]; 0 for the origin. Within 2e-5 degrees. *Pure.*
[[nodiscard]] constexpr float direction_deg(float x, float y) noexcept {
  constexpr std::uint32_t sign = 0x8000'0000U;
  const auto magnitude = [](float number) { return masked(~sign, number); };
  const std::uint32_t steep = negative_mask(magnitude(x) - magnitude(y));
  const float smaller = magnitude(chosen(steep, x, y));
  const float greater = magnitude(chosen(steep, y, x));
  const float slope = smaller / (greater + 1e-30F);  // 0 for the origin
  const float shallow = slope * compact_correction::arctangent_ratio(slope * slope);
  const float first = chosen(steep, 90.0F - shallow, shallow);
  const float upper = chosen(negative_mask(x), 180.0F - first, first);
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(upper) |
                              (std::bit_cast<std::uint32_t>(y) & sign));
}

/// Points as arrays, each with the place of the lidar when it measured the point.
struct point_block {
  static constexpr std::size_t capacity = 64;
  static constexpr double degrees = 180.0 / std::numbers::pi;
  using numbers = std::array<float, capacity>;

  numbers angle_deg;
  numbers range_mm;  ///< 0 for no return.
  /// Where the lidar was, seen from where it was at the reference time; at most 200 degrees.
  numbers turn_deg;
  numbers x_mm;
  numbers y_mm;
  std::array<std::int32_t, capacity> since_ns;  ///< The time since that of the first point.

  /// Takes direction and range of point `i`.
  constexpr void load(std::size_t i, const point& p) noexcept {
    angle_deg[i] = p.angle_deg;
    range_mm[i] = p.range_mm;
  }

  /// The place of the lidar for point `i`.
  constexpr void set_place(std::size_t i, const pose_2d& place) noexcept {
    turn_deg[i] = static_cast<float>(wrap_rad(place.yaw_rad) * degrees);
    x_mm[i] = static_cast<float>(place.x_m * 1000.0);
    y_mm[i] = static_cast<float>(place.y_m * 1000.0);
  }

  /// The places at `since_ns` on an arc that begins at `start`, for the first `count` points. The lidar turns there by
  /// at most 0.02 radians.
  constexpr void set_places(const pose_2d& start, const twist_2d& twist,
                            std::size_t count) noexcept {
    // The series of the position in powers of the time: each derivative is the one before it, turned by a quarter turn
    // and multiplied by the rate. The next terms are below 5e-7 of the way.
    const rotation r = rotation_by(start.yaw_rad);
    double x_rate = 1000.0 * (r.cosine * twist.x_m_per_s - r.sine * twist.y_m_per_s);
    double y_rate = 1000.0 * (r.sine * twist.x_m_per_s + r.cosine * twist.y_m_per_s);
    std::array<float, 3> x_series;
    std::array<float, 3> y_series;
    for (std::size_t power = 0; power < x_series.size(); ++power) {
      x_series[power] = static_cast<float>(x_rate);
      y_series[power] = static_cast<float>(y_rate);
      const double next = twist.yaw_rad_per_s / static_cast<double>(power + 2);
      const double turned = x_rate * next;
      x_rate = -y_rate * next;
      y_rate = turned;
    }
    const auto turn_rate = static_cast<float>(twist.yaw_rad_per_s * degrees);
    set_place(0, start);
    const float turn_0 = turn_deg[0];
    const float x_0 = x_mm[0];
    const float y_0 = y_mm[0];
    const auto [x_1, x_2, x_3] = x_series;
    const auto [y_1, y_2, y_3] = y_series;
    for (std::size_t i = 0; i < count; ++i) {
      const float t = static_cast<float>(since_ns[i]) * 1e-9F;
      turn_deg[i] = turn_0 + turn_rate * t;
      x_mm[i] = x_0 + t * (x_1 + t * (x_2 + t * x_3));
      y_mm[i] = y_0 + t * (y_1 + t * (y_2 + t * y_3));
    }
  }

  /// The first `count` points as seen from where the lidar was at the reference time.
  constexpr void move(std::size_t count) noexcept {
    std::uint32_t is_near = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const float turned = wrap_once_deg(angle_deg[i] + turn_deg[i]);
      const sine_cosine look = sine_cosine_deg(turned);
      // The way of the lidar, along the direction of the point and across it; none without a return.
      const std::uint32_t returned = negative_mask(0.0F - range_mm[i]);
      const float x = masked(returned, x_mm[i]);
      const float y = masked(returned, y_mm[i]);
      const float ahead = range_mm[i] + (look.cosine * x + look.sine * y);
      const float aside = look.cosine * y - look.sine * x;
      is_near |= negative_mask(ahead - 4.0F * aside) | negative_mask(ahead + 4.0F * aside);
      angle_deg[i] = turned;
      x_mm[i] = ahead;
      y_mm[i] = aside;
    }
    is_near != 0 ? turn_any(count) : turn_far(count);
  }

  /// The rest of move(): direction and length of (x_mm, y_mm), seen in the direction angle_deg.
  constexpr void turn_any(std::size_t count) noexcept {
    for (std::size_t i = 0; i < count; ++i) {
      angle_deg[i] = wrap_once_deg(angle_deg[i] + direction_deg(x_mm[i], y_mm[i]));
      range_mm[i] = square_root(x_mm[i] * x_mm[i] + y_mm[i] * y_mm[i]);
    }
  }
  /// The same where y is at most a quarter of x: the next terms of both series are below 1e-7 of the sums.
  constexpr void turn_far(std::size_t count) noexcept {
    constexpr auto d = static_cast<float>(degrees);
    for (std::size_t i = 0; i < count; ++i) {
      const float slope = y_mm[i] / (x_mm[i] + 1e-30F);  // 0 for the origin
      const float s = slope * slope;
      const float turn =
          slope * (d + s * (-d / 3.0F + s * (d / 5.0F + s * (-d / 7.0F + s * (d / 9.0F)))));
      const float longer = s * (0.5F + s * (-0.125F + s * (0.0625F + s * (-5.0F / 128.0F))));
      angle_deg[i] = wrap_once_deg(angle_deg[i] + turn);
      range_mm[i] = x_mm[i] + x_mm[i] * longer;
    }
  }

  /// Writes `points`, those that were loaded, with the new directions and ranges to `out`, which may be the same memory.
  constexpr void store(std::span<const point> points, std::span<point> out) const noexcept {
    if (out.data() != points.data()) std::copy(points.begin(), points.end(), out.begin());
    for (std::size_t i = 0; i < points.size(); ++i) {
      out[i].angle_deg = angle_deg[i];
      out[i].range_mm = range_mm[i];
      out[i].flags = without(out[i].flags, point_flags::not_deskewed);
    }
  }
};

}  // namespace g4lidar::detail
