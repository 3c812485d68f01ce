// SPDX-License-Identifier: MIT
// One simulation run of a driver, from open() to close(), in virtual time.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "invariant_checker.hpp"
#include "parameters.hpp"
#include "sample_matcher.hpp"

namespace g4lidar::simulation {

inline constexpr std::size_t event_kinds =
    static_cast<std::size_t>(lidar_event::kind::other_number) + 1;

struct run_report {
  std::string failure;         ///< Empty if nothing failed.
  std::int64_t failed_ns = 0;  ///< When.
  truth_counts truths;
  time_counts times;
  std::uint64_t holes = 0;  ///< Revolutions that seem whole and are not.
  std::uint64_t reconnects = 0;
  std::uint64_t opens = 0;
  std::uint64_t scans = 0;
  std::array<std::uint64_t, event_kinds> events{};
  std::int64_t recovery_ns = 0;  ///< From the last fault's end to a whole revolution.
  std::int64_t allowed_ns = 0;   ///< How long it might have taken.
  std::int64_t simulated_ns = 0;
  std::int64_t longest_start_ns = 0;
  std::int64_t longest_ask_ns = 0;
  std::int64_t longest_stop_ns = 0;
};

/// Runs it; prints what happens on the standard output, if `verbose`.
[[nodiscard]] run_report run_simulation(const run_parameters& parameters, bool verbose);

}  // namespace g4lidar::simulation
