// SPDX-License-Identifier: MIT
// The columns of what the samples of some models contain: intensity and flags.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "export/point_writer.hpp"

namespace g4lidar::test {
namespace {

using namespace g4_tool;
using nlohmann::json;
using ::testing::EndsWith;

point made(std::uint16_t intensity, std::uint8_t flags) {
  return {.angle_deg = 90.0F,
          .range_mm = 1234.5F,
          .time_ns = 7,
          .sample_flags = flags,
          .intensity = intensity};
}

std::string points_as(const text_style& style, std::span<const point> points) {
  std::string all;
  callback_sink sink([&all](std::string_view text) { all += text; });
  const auto writer = make_point_writer(style);
  writer->begin(sink);
  writer->write_points(points, sink);
  sink.flush();
  return all;
}

TEST(Csv, HasTheColumnsThatTheStyleHas) {
  const std::vector<point> points{made(65'535, 3)};
  EXPECT_EQ(points_as({.intensity = true, .sample_flags = true}, points),
            "scan,angle_deg,range_mm,time_ns,intensity,sample_flags\n"
            "0,90.000000,1234.50,7,65535,3\n");
  EXPECT_EQ(points_as({.intensity = true}, points),
            "scan,angle_deg,range_mm,time_ns,intensity\n0,90.000000,1234.50,7,65535\n");
  EXPECT_EQ(points_as({.sample_flags = true}, points),
            "scan,angle_deg,range_mm,time_ns,sample_flags\n0,90.000000,1234.50,7,3\n");
}

TEST(Csv, TheLongestRowFits) {
  point longest = made(65'535, 3);
  longest.angle_deg = 359.999969F;
  longest.range_mm = 99'999'999.0F;
  longest.time_ns = std::numeric_limits<std::int64_t>::min();
  longest.revolution = 4'294'967'295;
  const std::vector<point> points(5000, longest);
  const std::string text = points_as({.intensity = true, .sample_flags = true}, points);
  EXPECT_EQ(std::ranges::count(text, '\n'), 5001);
  EXPECT_THAT(text, EndsWith(",-9223372036854775808,65535,3\n"));
}

TEST(Jsonl, HasTheKeysThatTheStyleHas) {
  const std::vector<point> points{made(1023, 2)};
  text_style style{.format = text_format::jsonl, .as_they_come = true};
  EXPECT_FALSE(json::parse(points_as(style, points)).contains("intensity"));
  EXPECT_FALSE(json::parse(points_as(style, points)).contains("sample_flags"));
  style.intensity = style.sample_flags = true;
  const auto object = json::parse(points_as(style, points));
  EXPECT_EQ(object["intensity"], 1023);
  EXPECT_EQ(object["sample_flags"], 2);
}

TEST(Jsonl, RevolutionsHaveTheArraysThatTheStyleHas) {
  const std::vector<point> points{made(1023, 2), made(5, 0)};
  scan_record record;
  record.scan.points = points;
  std::string all;
  callback_sink sink([&all](std::string_view text) { all += text; });
  make_point_writer(
      {.format = text_format::jsonl, .scans = true, .intensity = true, .sample_flags = true})
      ->write_scan(record, sink);
  sink.flush();
  const auto object = json::parse(all);
  EXPECT_EQ(object["intensity"], (json{1023, 5}));
  EXPECT_EQ(object["sample_flags"], (json{2, 0}));
}

}  // namespace
}  // namespace g4lidar::test
