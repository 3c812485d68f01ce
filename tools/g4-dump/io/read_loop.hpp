// SPDX-License-Identifier: MIT
// The loop of a command that reads a lidar or a recording until -n, -d, --idle or ^C ends it.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "cli/common_options.hpp"
#include "g4lidar/lidar.hpp"

namespace g4_tool {

class opened_source;
class output;

/// The receiver of the data.
struct read_sink {
  /// If set: scans are read instead of points. Returns the number of records that it has written.
  std::function<std::uint64_t(const g4lidar::scan&)> scan{};
  std::function<void(std::span<const g4lidar::point>)> points{};
  /// If set: called at least every 100 ms.
  std::function<void()> pulse{};
  /// If set: whether to end; else -n counts records.
  std::function<bool()> is_done{};
  bool with_bar = true;  ///< Shows the progress through a recording.
};

/// Starts the lidar, reads it and stops it. Ends by the options, a signal, the end of a recording, or when
/// the reader of `out` closes it. Logs events. Flushes a terminal before each wait, a pipe or a file
/// within 50 ms. Throws a failure if the lidar is lost.
void read_source(opened_source& source, const common_options& options, const read_sink& sink,
                 output& out);

/// Logs the events since the last call.
void report_events(g4lidar::lidar& lidar);

/// Logs the counts at the end. `has_scans`: scans were read instead of points, and may have been missed.
void report_counts(const g4lidar::lidar_counts& counts, bool has_scans = false);

}  // namespace g4_tool
