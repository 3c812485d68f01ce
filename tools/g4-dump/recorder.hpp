// SPDX-License-Identifier: MIT
// A source to a recording, with all that goes over its line: what record does, and convert to one.
#pragma once

#include <cstdint>
#include <string>

#include "common_options.hpp"
#include "g4lidar/recording.hpp"
#include "source.hpp"

namespace g4_dump {

/// What is recorded, and how.
struct recording_job {
  common_options common;  ///< The source, and when it ends.
  opening source;         ///< Its tap is the recorder's.
  std::string path;       ///< Of the recording.
  std::string title{};    ///< How it is called in words; empty: its path.
  g4lidar::recording_options made;
  bool scans = true;         ///< Whether revolutions are kept as LaserScan, too.
  bool shows_counts = true;  ///< While it runs, on a terminal.
};

/// What a finished recording holds.
struct recorded_result {
  g4lidar::lidar_counts lidar;
  g4lidar::recording_counts file;
  g4lidar::recorded_digest digest;
  g4lidar::recording_damage damage;  ///< Of the source, where that is a recording.
};

/// Records until one of the options' ends, a signal, or the end of the source. Whatever happens, the
/// file is ended properly; where the source cannot be opened there is none. Throws a failure: of the
/// source, or of the disk.
recorded_result record(const recording_job& job);

/// "g4-dump: cannot make ..." for what the library says about a recording's file.
[[nodiscard]] std::string words_about_file(const g4lidar::error& why, const std::string& path);

/// The lines at the end: what is in the file, and its digests.
void tell_recorded(const recorded_result& result, const std::string& path);

}  // namespace g4_dump
