// SPDX-License-Identifier: MIT
// A source to a recording, with all bytes both ways: what record does, and convert to a recording.
#pragma once

#include <optional>
#include <string>

#include "cli/common_options.hpp"
#include "g4lidar/recording/writer.hpp"
#include "io/source.hpp"

namespace g4_tool {

/// What is recorded, and how.
struct recording_job {
  /// The source, and when it ends; --odometry, which replaces that of a recording; --mount.
  common_options common;
  lidar_options source;  ///< But for `wrap`, which is the recorder's.
  std::string path;      ///< Of the recording.
  std::string title{};   ///< Its name in messages; empty: its path.
  g4lidar::recording_options made;
  bool is_kept = true;       ///< Also after a failure: what was written before it can be read.
  bool shows_counts = true;  ///< While it runs, on a terminal.
  /// The file of a source that could not be opened stays if it holds bytes of the attempt.
  bool keeps_attempt = false;
};

/// What a finished recording holds.
struct recorded_result {
  g4lidar::lidar_counts lidar;
  g4lidar::recording_counts file;
  g4lidar::recorded_digest digest;
  /// Of the source, where that is a recording: what it lost, and the digest that is kept in it.
  g4lidar::recording_damage damage;
  std::optional<g4lidar::recorded_digest> recorded;
};

/// --points and --order.
[[nodiscard]] option_rows message_rows(g4lidar::recording_options& into);

/// Records until one of the options' ends, a signal, or the end of the source. Whatever happens, the
/// file is ended properly; where the source cannot be opened there is none. Throws a failure: of the
/// source, or of the disk.
recorded_result record(const recording_job& job);

/// The lines at the end: what is in the file, and its digests.
void report_recorded(const recorded_result& result, const std::string& path);

}  // namespace g4_tool
