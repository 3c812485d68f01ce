// SPDX-License-Identifier: MIT
// One life of a driver, from open() to close(), in virtual time.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "plan.hpp"
#include "truth_book.hpp"
#include "watch.hpp"

namespace g4lidar::lives {

struct life_report {
  std::string failure;         ///< Empty if all was well.
  std::int64_t failed_ns = 0;  ///< When.
  truth_counts truths;
  time_counts times;
  std::uint64_t holes = 0;  ///< Revolutions that seem whole and are not.
  std::uint64_t reconnects = 0;
  std::uint64_t opens = 0;
  std::uint64_t scans = 0;
  std::array<std::uint64_t, 8> events{};
  std::int64_t recovery_ns = 0;  ///< From the last fault's end to a whole revolution.
  std::int64_t allowed_ns = 0;   ///< How long it might have taken.
  std::int64_t lived_ns = 0;
  std::int64_t longest_start_ns = 0;
  std::int64_t longest_ask_ns = 0;
  std::int64_t longest_stop_ns = 0;
};

/// Lives it; says what happens on the standard output, if `verbose`.
[[nodiscard]] life_report live(const life_plan& plan, bool verbose);

}  // namespace g4lidar::lives
