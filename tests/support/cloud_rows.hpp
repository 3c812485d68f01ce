// SPDX-License-Identifier: MIT
// The points of PointCloud2 messages, and those of a drive as a scan_shaper shapes them, without pieces of revolutions.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "shaped_drive.hpp"

namespace g4lidar::test {

inline constexpr std::size_t cloud_row_size = 24;  // x, y, z, t, range, angle

/// The rows of a message without their times: these depend on the stamp.
inline std::string without_times(std::string rows) {
  for (std::size_t at = 12; at < rows.size(); at += cloud_row_size) rows.replace(at, 4, 4, '\0');
  return rows;
}

/// As the options of shaped_drive.hpp.
inline shaping_options drive_shaping(deskewing how = deskewing::by_scans) {
  return {.filter = {.least_range_mm = 300.0F},
          .marks = {.speckle = speckle_limits{}, .edges = edge_limits{}, .near = near_limits{}},
          .deskew = how};
}

/// Shapes the scans of a drive; calls `use(shaper, scan)` after each.
template <class Use>
void shape_drive(const shaped_drive& drive, bool pieces, deskewing how, Use use) {
  auto opened = lidar::open("file:" + drive.recording(), {.partial_scans = pieces});
  ASSERT_TRUE(opened && opened->start());
  scan_shaper shaper(drive_shaping(how));
  const auto path = drive.poses();
  while (const auto scan = opened->try_scan(std::chrono::milliseconds(500))) {
    shaper.shape(*scan, path);
    use(shaper, *scan);
  }
}

/// Rows of points, without their times.
inline std::string rows_of(std::span<const point> points, std::int64_t stamp_ns) {
  std::vector<std::uint8_t> message;
  put_point_cloud2(points, {.stamp_ns = stamp_ns, .frame_id = "laser"}, message);
  const std::ptrdiff_t size =
      std::ranges::count_if(points, [](const point& p) { return !p.is_no_return(); }) *
      static_cast<std::ptrdiff_t>(cloud_row_size);
  const auto end = message.end() - 1;  // one more byte follows the rows
  return without_times({end - size, end});
}

/// Such rows of each revolution of a drive.
inline std::vector<std::string> cloud_rows_of(const shaped_drive& drive,
                                              deskewing how = deskewing::by_scans) {
  std::vector<std::string> made;
  shape_drive(drive, false, how, [&](scan_shaper& shaper, const scan& of) {
    made.push_back(rows_of(shaper.kept().points, of.time_ns()));
  });
  EXPECT_GT(made.size(), 30U);
  return made;
}

}  // namespace g4lidar::test
