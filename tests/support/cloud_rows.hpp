// SPDX-License-Identifier: MIT
// The points of PointCloud2 messages, and those of a drive as a scan_shaper shapes them, without pieces of revolutions.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/scan_shaper.hpp"

namespace g4lidar::test {

inline constexpr std::size_t cloud_row_size = 24;  // x, y, z, t, range, angle

/// The rows of a message without their times: these depend on the stamp.
inline std::string without_times(std::string rows) {
  for (std::size_t at = 12; at < rows.size(); at += cloud_row_size) rows.replace(at, 4, 4, '\0');
  return rows;
}

/// As shaping_words of shaped_drive.hpp.
inline shaping_options drive_shaping() {
  return {.filter = {.least_range_mm = 300.0F},
          .marks = {.speckle = speckle_limits{}, .edges = edge_limits{}, .near = near_limits{}},
          .deskew = deskewing::by_scans};
}

/// Such rows of each revolution of a recording.
inline std::vector<std::string> cloud_rows_of(const std::string& recording) {
  auto opened = lidar::open("file:" + recording);
  EXPECT_TRUE(opened && opened->start());
  scan_shaper shaper(drive_shaping());
  std::vector<std::string> made;
  while (const auto scan = opened->next_scan(std::chrono::milliseconds(500))) {
    shaper.shape(*scan);
    const auto kept = shaper.kept();
    std::vector<std::uint8_t> message;
    put_point_cloud2(kept, {.stamp_ns = scan->time_ns(), .frame_id = "laser"}, message);
    const std::ptrdiff_t size =
        std::ranges::count_if(kept, [](const point& p) { return !p.is_no_return(); }) *
        static_cast<std::ptrdiff_t>(cloud_row_size);
    const auto end = message.end() - 1;  // one more byte follows the rows
    made.push_back(without_times({end - size, end}));
  }
  EXPECT_GT(made.size(), 30U);
  return made;
}

}  // namespace g4lidar::test
