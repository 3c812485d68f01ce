// SPDX-License-Identifier: MIT
// The loop of a command that reads a lidar: until enough has come, the time is over, or ^C.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <span>

#include "common_options.hpp"
#include "g4lidar/lidar.hpp"

namespace g4_dump {

class output;

/// What a command does with what comes. Each gives how many records that made.
struct live_sink {
  /// Where it is set, scans are read; else points.
  std::function<std::uint64_t(const g4lidar::scan&)> scan{};
  std::function<std::uint64_t(std::span<const g4lidar::point>)> points{};
  /// Called at least every 100 ms, where it is set.
  std::function<void()> pulse{};
  /// Whether there has been enough, where it is set; then it, and not -n, counts records, and gets all
  /// points of a reading.
  std::function<bool()> is_done{};
};

/// Starts the lidar, reads it until one of the options' ends, a signal, the end of a recording, or
/// nobody reads `out` any more; stops it. What happens by itself is told. A terminal is shown
/// everything before each wait; a pipe or a file gets it after 50 ms at most. Throws a failure where
/// the lidar is lost.
void run_live(g4lidar::lidar& lidar, const common_options& options, const live_sink& sink,
              output& out);

/// Tells what has happened by itself since it was asked last.
void tell_events(g4lidar::lidar& lidar);

/// What a command has read: of that it may have missed some.
enum class reading : unsigned char { points, scans };

/// The counts at the end, as tcpdump tells them.
void tell_counts(const g4lidar::lidar& lidar, reading what);
void tell_counts(const g4lidar::lidar_counts& counts, reading what);

}  // namespace g4_dump
