// SPDX-License-Identifier: MIT
// The verb convert: recordings, raw bytes, csv, jsonl and pcd, from one to another.
#pragma once

#include <cstdint>
#include <optional>

#include "common_options.hpp"
#include "g4lidar/recording.hpp"
#include "g4lidar/recording_reader.hpp"

namespace g4_dump {

enum class file_form : unsigned char { recording, raw_bytes, csv, jsonl, pcd };

struct convert_options {
  shared_options common =
      std::make_shared<common_options>();  ///< Its source is IN, its output OUT.
  std::optional<file_form> from;           ///< Else by what lies there.
  std::optional<file_form> to;             ///< Else by the name.
  g4lidar::reading_options range;
  g4lidar::frame from_frame = g4lidar::frame::vendor;  ///< That the angles of text are in.
  bool scans = false;     ///< A record for each revolution, in csv and jsonl.
  bool shapes = false;    ///< Something was asked for that only points can have.
  bool is_ascii = false;  ///< pcd.
  std::uint32_t rate_hz = 9000;
  g4lidar::recording_options made;  ///< Where OUT is a recording.
};

/// Returns the exit code; throws a failure.
[[nodiscard]] int run(const convert_options& options);

}  // namespace g4_dump
