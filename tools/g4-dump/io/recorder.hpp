// SPDX-License-Identifier: MIT
// Records a source, with all bytes both ways: for record, and for convert to a recording.
#pragma once

#include <optional>
#include <string>

#include "cli/common_options.hpp"
#include "cli/exit_code.hpp"
#include "g4lidar/recording/writer.hpp"
#include "io/source_word.hpp"

namespace g4_tool {

/// What is recorded, and how.
struct recording_job {
  /// The source and the end conditions; --odometry, which replaces that of a recording; --mount.
  common_options common;
  lidar_options source;  ///< Its `wrap` is not used.
  std::string path;      ///< Of the recording.
  std::string title{};   ///< Its name in messages; empty: its path.
  g4lidar::recording_options made;
  bool is_kept = true;       ///< The file remains after a failure, and can be read.
  bool shows_counts = true;  ///< Shows a status line on a terminal.
  /// If the source cannot be opened: keeps the file if it contains bytes of the attempt.
  bool keeps_attempt = false;
};

/// The contents of a finished recording.
struct recorded_result {
  g4lidar::lidar_counts lidar;
  g4lidar::recording_counts file;
  g4lidar::recorded_digest digest;
  /// If the source is a recording: its damage, and the digest that is stored in it.
  g4lidar::recording_damage damage;
  std::optional<g4lidar::recorded_digest> recorded;
};

/// --points and --order.
[[nodiscard]] option_rows message_rows(g4lidar::recording_options& into);

/// Records until an end condition, a signal, or the end of the source. The file is always completed; there
/// is none if the source cannot be opened. Throws a failure of the source or of the disk.
recorded_result record(const recording_job& job);

/// The failure for an error of the file of a recording. `is_kept`: what was written before remains.
[[nodiscard]] failure file_failure(const g4lidar::error& why, const std::string& path,
                                   bool is_kept);

/// Logs the contents of the file and its digests.
void report_recorded(const recorded_result& result, const std::string& path);

}  // namespace g4_tool
