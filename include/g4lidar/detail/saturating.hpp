// SPDX-License-Identifier: MIT
// Arithmetic on times, and conversions of numbers to integers, that end at the largest and the least value.
#pragma once

#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "g4lidar/detail/api.hpp"

namespace g4lidar::detail {

/// *Pure.*
[[nodiscard]] constexpr std::int64_t saturating_add(std::int64_t a, std::int64_t b) noexcept {
  std::int64_t sum = 0;
  using limits = std::numeric_limits<std::int64_t>;
  if (__builtin_add_overflow(a, b, &sum)) return a < 0 ? limits::min() : limits::max();
  return sum;
}
/// *Pure.*
[[nodiscard]] constexpr std::int64_t saturating_sub(std::int64_t a, std::int64_t b) noexcept {
  std::int64_t difference = 0;
  using limits = std::numeric_limits<std::int64_t>;
  if (__builtin_sub_overflow(a, b, &difference)) return a < 0 ? limits::min() : limits::max();
  return difference;
}
/// *Pure.*
[[nodiscard]] constexpr std::int64_t saturating_twice(std::int64_t a) noexcept {
  return saturating_add(a, a);
}

/// A sum and a difference that wrap, for what is within its limits unless the caller makes a mistake: they cost no
/// more than any others. *Pure.*
[[nodiscard]] constexpr std::int64_t wrapping_add(std::int64_t a, std::int64_t b) noexcept {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}
/// The same.
[[nodiscard]] constexpr std::int64_t wrapping_sub(std::int64_t a, std::int64_t b) noexcept {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}

/// Whether the whole part of `value` is an `Integer`, but the least one of a signed type; false for what is not a
/// number. *Pure.*
template <std::integral Integer, std::floating_point Real>
[[nodiscard]] constexpr bool fits(Real value) noexcept {
  constexpr Integer half = std::numeric_limits<Integer>::max() / 2 + 1;  // a power of two
  constexpr Real beyond = Real(2) * static_cast<Real>(half);
  // g++ 11 has no other constant comparison of what is not a number.
  // NOLINTNEXTLINE(misc-redundant-expression): not a number
  if (std::is_constant_evaluated() && value != value) return false;
  if constexpr (std::is_unsigned_v<Integer>) {
    return value >= Real(0) && value < beyond;
  } else if constexpr (std::is_same_v<Real, float>) {
    return __builtin_fabsf(value) < beyond;
  } else {
    return __builtin_fabs(value) < beyond;
  }
}
/// `value` without its fraction, or the nearest `Integer`; 0 for what is not a number. *Pure.*
template <std::integral Integer, std::floating_point Real>
[[nodiscard]] constexpr Integer saturated(Real value) noexcept {
  using limits = std::numeric_limits<Integer>;
  if (fits<Integer>(value)) return static_cast<Integer>(value);
  if (value != value) return 0;  // NOLINT(misc-redundant-expression): not a number
  return value < Real(0) ? limits::min() : limits::max();
}

}  // namespace g4lidar::detail
