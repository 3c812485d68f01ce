// SPDX-License-Identifier: MIT
// The loop of a command that reads a lidar or a recording: until enough has come, the time is over, or ^C.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "cli/common_options.hpp"
#include "g4lidar/lidar.hpp"

namespace g4_tool {

class opened_source;
class output;

/// What a command does with what comes.
struct read_sink {
  /// Where it is set, scans are read, and it gives how many records that made; else points.
  std::function<std::uint64_t(const g4lidar::scan&)> scan{};
  std::function<void(std::span<const g4lidar::point>)> points{};
  /// Called at least every 100 ms, where it is set.
  std::function<void()> pulse{};
  /// Whether there has been enough, where it is set; else -n counts records.
  std::function<bool()> is_done{};
  bool with_bar = true;  ///< Whether to show how far a recording has been read.
};

/// Starts the lidar, reads it until one of the options' ends, a signal, the end of a recording, or
/// nobody reads `out` any more; stops it. Events are reported. A terminal is shown
/// everything before each wait; a pipe or a file gets it after 50 ms at most. Throws a failure where
/// the lidar is lost.
void read_source(opened_source& source, const common_options& options, const read_sink& sink,
                 output& out);

/// Reports the events since the last call.
void report_events(g4lidar::lidar& lidar);

/// Writes the counts at the end to standard error. `has_scans`: scans were read, and not points, so
/// that scans may have been missed.
void report_counts(const g4lidar::lidar_counts& counts, bool has_scans = false);

}  // namespace g4_tool
