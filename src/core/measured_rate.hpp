// SPDX-License-Identifier: MIT
// Whether a model may have a sample rate that was measured.
#pragma once

#include <algorithm>
#include <cstdint>

#include "g4lidar/core/model.hpp"

namespace g4lidar {

/// The difference between what was measured and the nearest sample rate of the row, in percent. *Pure.*
[[nodiscard]] inline std::uint32_t rate_difference(const model& row, std::uint32_t hz) noexcept {
  std::uint32_t least = hz == 0 ? 0 : 100;
  for (const sample_rate_entry& own : row.rates.entries) {
    if (own.hz == 0 || hz == 0) continue;
    const std::uint32_t off = own.hz > hz ? own.hz - hz : hz - own.hz;
    least = std::min(least, 100 * off / own.hz);
  }
  return least;
}

/// Whether it measures so many samples a second at one of its rates, to a tenth. 0: not known, and true. *Pure.*
[[nodiscard]] inline bool may_measure(const model& row, std::uint32_t hz) noexcept {
  return rate_difference(row, hz) <= 10 || is_seen_rate(row, hz);
}

}  // namespace g4lidar
