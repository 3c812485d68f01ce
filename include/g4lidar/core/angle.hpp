// SPDX-License-Identifier: MIT
// An angle on the circle: it wraps, has no order, and is never 360.
#pragma once

#include <bit>
#include <cstdint>
#include <numbers>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/detail/saturating.hpp"

namespace g4lidar {

/// All bits set if `x` is negative (or -0), else no bit. *Pure.* With it a choice between two
/// numbers needs no branch, so that a compiler can vectorize a loop over the choice.
[[nodiscard]] constexpr std::uint32_t negative_mask(float x) noexcept {
  return static_cast<std::uint32_t>(std::bit_cast<std::int32_t>(x) >> 31);
}

/// `number` if `mask` has all bits set, 0 if it has none. *Pure.*
[[nodiscard]] constexpr float masked(std::uint32_t mask, float number) noexcept {
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(number) & mask);
}

/// `degrees` wrapped into [0, 360). *Pure.* Accepts -360 <= degrees < 720, the range of the sum of
/// a first-level angle and a correction. A tiny negative number, to which adding 360 gives 360 by
/// rounding, becomes 0.
[[nodiscard]] constexpr float wrap_once_deg(float degrees) noexcept {
  const float lifted = degrees + masked(negative_mask(degrees), 360.0F);
  return lifted - masked(~negative_mask(lifted - 360.0F), 360.0F);
}
/// The same in double precision.
[[nodiscard]] constexpr double wrap_once_deg(double degrees) noexcept {
  const double lifted = degrees < 0.0 ? degrees + 360.0 : degrees;
  return lifted >= 360.0 ? lifted - 360.0 : lifted;
}

/// `degrees` wrapped into [0, 360), for any number of turns; 0 for a number that has no direction: not a
/// number, and 2^63 and more in magnitude. *Pure.*
template <class Real>
[[nodiscard]] constexpr Real wrap_deg(Real degrees) noexcept {
  if (!detail::fits<std::int64_t>(degrees)) return Real(0);
  // Whole degrees are wrapped as an integer, so that large numbers lose no precision.
  const auto whole = static_cast<std::int64_t>(degrees);
  const Real fraction = degrees - static_cast<Real>(whole);
  return wrap_once_deg(static_cast<Real>(whole % 360) + fraction);
}

/// Sine and cosine of one angle.
struct sine_cosine {
  float sine;
  float cosine;
};

/// Sine and cosine of `degrees` in [0, 360), without libm. *Pure.* Within 1.2e-7 of the true values. Those
/// of other numbers are less exact, and from 1e6 on any numbers.
[[nodiscard]] constexpr sine_cosine sine_cosine_deg(float degrees) noexcept {
  // The nearest multiple of 90 is subtracted exactly; the rest, at most 45, goes into two series.
  // At this height the last bit of a float has the value 1, so its bits have the integer; those of any
  // number are one, without a branch.
  constexpr float height = 0x1.8p23F;
  const auto quarter =
      static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(degrees * (1.0F / 90.0F) + height) -
                                std::bit_cast<std::uint32_t>(height));
  const float x =
      (degrees - static_cast<float>(quarter) * 90.0F) * (std::numbers::pi_v<float> / 180.0F);
  const float x2 = x * x;
  const float s =
      x +
      x * x2 * (-1.6666667e-1F + x2 * (8.3333310e-3F + x2 * (-1.9840874e-4F + x2 * 2.7525562e-6F)));
  const float c =
      1.0F + x2 * (-0.5F + x2 * (4.1666666e-2F + x2 * (-1.3888885e-3F + x2 * 2.4760495e-5F)));
  // An odd number of quarters exchanges the two; each has its sign in two of four quarters. No
  // branch, so that a compiler can vectorize a loop over it.
  const auto turns = static_cast<std::uint32_t>(quarter);
  const std::uint32_t odd = 0U - (turns & 1U);
  const auto bits = [](float number) { return std::bit_cast<std::uint32_t>(number); };
  const auto either = [&](float a, float b, std::uint32_t sign) {
    return std::bit_cast<float>(((bits(a) & odd) | (bits(b) & ~odd)) ^ ((sign & 2U) << 30U));
  };
  return {either(c, s, turns), either(s, c, turns + 1U)};
}

/// An angle on the circle. Sums and differences wrap. Two angles are equal or not, and neither is
/// smaller: an order needs a direction, so `<` does not compile.
class angle {
 public:
  /// 0 degrees.
  constexpr angle() noexcept = default;

  /// Any number of degrees; see wrap_deg().
  [[nodiscard]] static constexpr angle from_degrees(float degrees) noexcept {
    return angle(wrap_deg(degrees));
  }
  /// Any number of radians.
  [[nodiscard]] static constexpr angle from_radians(float radians) noexcept {
    return angle(wrap_deg(radians * (180.0F / std::numbers::pi_v<float>)));
  }

  /// In [0, 360); never 360.
  [[nodiscard]] constexpr float degrees() const noexcept { return degrees_; }
  /// In [-180, 180).
  [[nodiscard]] constexpr float signed_degrees() const noexcept {
    return degrees_ >= 180.0F ? degrees_ - 360.0F : degrees_;
  }
  /// In [-pi, pi).
  [[nodiscard]] constexpr float radians() const noexcept {
    return signed_degrees() * (std::numbers::pi_v<float> / 180.0F);
  }

  /// The turn from this angle to `other`, in the direction in which this angle grows: degrees in
  /// [0, 360).
  [[nodiscard]] constexpr float forward_to(angle other) const noexcept {
    return wrap_once_deg(other.degrees_ - degrees_);
  }
  /// The shorter turn to `other`, in either direction: degrees in [0, 180].
  [[nodiscard]] constexpr float apart_from(angle other) const noexcept {
    const float way = forward_to(other);
    return way > 180.0F ? 360.0F - way : way;
  }

  /// The sum, wrapped into [0, 360); exact except for rounding, like the next two.
  [[nodiscard]] friend constexpr angle operator+(angle a, angle b) noexcept {
    return angle(wrap_once_deg(a.degrees_ + b.degrees_));
  }
  /// The difference, wrapped.
  [[nodiscard]] friend constexpr angle operator-(angle a, angle b) noexcept {
    return angle(wrap_once_deg(a.degrees_ - b.degrees_));
  }
  /// The opposite turn, wrapped.
  [[nodiscard]] constexpr angle operator-() const noexcept {
    return angle(wrap_once_deg(-degrees_));
  }
  /// Equal in every bit except the sign of 0; after arithmetic use apart_from() instead.
  [[nodiscard]] friend constexpr bool operator==(angle, angle) noexcept = default;
  /// Deleted: a circle has no order; forward_to() gives the turn in one direction.
  friend constexpr auto operator<=>(angle, angle) = delete;

 private:
  explicit constexpr angle(float wrapped_degrees) noexcept : degrees_(wrapped_degrees) {}

  float degrees_ = 0.0F;
};

}  // namespace g4lidar
