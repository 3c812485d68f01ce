// SPDX-License-Identifier: MIT
// Points or revolutions of any source to a file: what dump, scan, decode, replay and convert do.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "cli/common_options.hpp"
#include "export/pcd.hpp"
#include "export/point_file.hpp"
#include "export/text_points.hpp"
#include "io/source.hpp"

namespace g4_tool {

/// The formats of which a file holds one revolution.
enum class scan_file : unsigned char { none, pcd, svg };

/// The formats for SLAM programs, with a line for each revolution.
enum class slam_log : unsigned char { none, carmen, tum };

struct point_job {
  shared_options common = std::make_shared<common_options>();
  text_style style{.format = text_format::text, .as_they_come = true};
  bool returns_only = false;         ///< Without the points from which nothing came back.
  bool partial = false;              ///< Whether pieces of revolutions are written, too.
  std::size_t bins = 0;              ///< 0: points and no grid.
  scan_file file = scan_file::none;  ///< One file for each revolution.
  pcd_data data = pcd_data::binary;
  std::optional<point_file_format> point_file;  ///< One file for all points.
  slam_log log = slam_log::none;                ///< carmen: of `bins` ranges.
  lidar_options source{};  ///< How it is opened; the range of `playback` holds for files, too.
  std::optional<text_source> text;  ///< The source holds points as text, in this format.
  g4lidar::frame text_frame = g4lidar::frame::vendor;  ///< Of the angles in that text.
  bool whole_file = false;   ///< OUT appears at the end, even where the source is a pipe.
  bool json_counts = false;  ///< The counts of raw bytes as JSON.
};

/// Returns the exit code; throws a failure or a bad_value.
[[nodiscard]] int run(const point_job& job);

}  // namespace g4_tool
