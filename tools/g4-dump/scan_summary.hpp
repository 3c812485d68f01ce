// SPDX-License-Identifier: MIT
// What there is to say about a revolution beside its points, the same in every format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "g4lidar/scan.hpp"
#include "point_writer.hpp"

namespace g4_dump {

/// A revolution in a few numbers.
struct scan_summary {
  std::size_t points = 0;    ///< That are written.
  std::size_t returns = 0;   ///< Of those, the ones from which something came back.
  double reported_hz = 0.0;  ///< 0 where the device did not report it.
};

[[nodiscard]] scan_summary summary_of(const shown_scan& shown, const point_style& style);

/// A revolution whose times were counted at the style's rate, so that they tell nothing of their own.
[[nodiscard]] shown_scan counted_scan(const g4lidar::scan& scan, std::uint32_t rate_hz);

/// The names of the marks that are set, `before` and `after` each and `between` them.
[[nodiscard]] std::string names_of(g4lidar::scan_marks marks, std::string_view before,
                                   std::string_view between, std::string_view after);

}  // namespace g4_dump
