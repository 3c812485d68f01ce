// SPDX-License-Identifier: MIT
// Arithmetic on times that saturates at the largest and the least value.
#pragma once

#include <cstdint>
#include <limits>

namespace g4lidar {

/// *Pure.*
[[nodiscard]] constexpr std::int64_t saturating_add(std::int64_t a, std::int64_t b) noexcept {
  using limits = std::numeric_limits<std::int64_t>;
  if (b > 0 && a > limits::max() - b) return limits::max();
  if (b < 0 && a < limits::min() - b) return limits::min();
  return a + b;
}
/// *Pure.*
[[nodiscard]] constexpr std::int64_t saturating_sub(std::int64_t a, std::int64_t b) noexcept {
  using limits = std::numeric_limits<std::int64_t>;
  if (b < 0 && a > limits::max() + b) return limits::max();
  if (b > 0 && a < limits::min() + b) return limits::min();
  return a - b;
}
/// `value` in nanoseconds; not a number counts as 0. *Pure.*
[[nodiscard]] constexpr std::int64_t saturating_ns(double value) noexcept {
  using limits = std::numeric_limits<std::int64_t>;
  constexpr double beyond = 9223372036854775808.0;
  if (value != value) return 0;  // first: g++ 11 has no other constant comparison of it
  if (value >= beyond) return limits::max();
  if (value < -beyond) return limits::min();
  return static_cast<std::int64_t>(value);
}

}  // namespace g4lidar
