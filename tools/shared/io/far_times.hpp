// SPDX-License-Identifier: MIT
// Sums and differences of times from a file, which may be any numbers: they end at the largest and the least one.
#pragma once

#include <cstdint>
#include <limits>

namespace g4_tool {

[[nodiscard]] constexpr std::int64_t sum_ns(std::int64_t a, std::int64_t b) noexcept {
  std::int64_t made = 0;
  using limits = std::numeric_limits<std::int64_t>;
  if (__builtin_add_overflow(a, b, &made)) return a < 0 ? limits::min() : limits::max();
  return made;
}
/// From `from_ns` to `to_ns`.
[[nodiscard]] constexpr std::int64_t way_ns(std::int64_t from_ns, std::int64_t to_ns) noexcept {
  std::int64_t made = 0;
  using limits = std::numeric_limits<std::int64_t>;
  if (__builtin_sub_overflow(to_ns, from_ns, &made))
    return to_ns < 0 ? limits::min() : limits::max();
  return made;
}

}  // namespace g4_tool
