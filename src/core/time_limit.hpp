// SPDX-License-Identifier: MIT
// Times that a caller gives, limited to what can be added to the time of now.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace g4lidar {

/// `given` in nanoseconds: less than 0 counts as 0, and more than a year as a year.
template <class Duration>
[[nodiscard]] constexpr std::int64_t limited_ns(Duration given) noexcept {
  constexpr Duration longest = std::chrono::hours(24 * 365);
  return std::chrono::nanoseconds(std::clamp(given, Duration(0), longest)).count();
}

}  // namespace g4lidar
