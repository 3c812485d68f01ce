// SPDX-License-Identifier: MIT
// CARMEN logs and TUM trajectories: the fields of each line, and where a reader places each range.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "export/slam_text.hpp"

namespace g4lidar {
namespace {

using namespace g4_tool;

constexpr double pi = std::numbers::pi;

std::string written(const auto& write) {
  std::string all;
  callback_sink sink([&](std::string_view text) { all += text; });
  write(sink);
  sink.flush();
  return all;
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

TEST(SlamText, CarmenLine_PlacesEachRangeWhereItWasMeasured) {
  constexpr std::size_t bins = 8;
  const std::array<float, bins> ranges{1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F, 7.0F, 8.0F};
  const carmen_scan scan{.ranges_m = ranges,
                         .robot = {10.0, 20.0, 0.5},
                         .mount = {0.2, 0.0, pi / 2},
                         .stamp_ns = 1'234'567'890};
  const auto words = words_of(written([&](text_sink& out) { write_carmen_scan(scan, out); }));
  ASSERT_EQ(words.size(), 9U + bins + 1 + 3 + 3 + 5 + 3);
  EXPECT_EQ(words[0], "ROBOTLASER1");
  EXPECT_EQ(words[8], "8");
  EXPECT_EQ(words[9 + bins], "0") << "no intensities";
  const auto number = [&](std::size_t i) { return std::stod(words.at(i)); };
  const std::size_t laser = 9 + bins + 1;
  // As MRPT reads it: n ranges, symmetric over the field of view, around the yaw of the laser.
  const double view = number(3);
  for (std::size_t i = 0; i < bins; ++i) {
    const double angle = -view / 2 + view * static_cast<double>(i) / (bins - 1) + number(laser + 2);
    const double true_angle = -pi + 2 * pi * static_cast<double>(i) / bins + 0.5 + pi / 2;
    EXPECT_NEAR(std::remainder(angle - true_angle, 2 * pi), 0.0, 1e-5) << i;
    EXPECT_NEAR(number(9 + i), static_cast<double>(ranges[i]), 1e-4);
  }
  EXPECT_NEAR(number(laser), 10.0 + 0.2 * std::cos(0.5), 1e-5);
  EXPECT_NEAR(number(laser + 1), 20.0 + 0.2 * std::sin(0.5), 1e-5);
  EXPECT_NEAR(number(laser + 5), 0.5, 1e-5) << "the yaw of the robot";
  EXPECT_EQ(words[words.size() - 3], "1.234567");
  EXPECT_EQ(words[words.size() - 1], "1.234567");
}

TEST(SlamText, CarmenLine_HasNoInfinityAndNoNan) {
  const float inf = std::numeric_limits<float>::infinity();
  const std::array<float, 4> ranges{inf, std::numeric_limits<float>::quiet_NaN(), 0.0F, 1.5F};
  const auto words = words_of(written(
      [&](text_sink& out) { write_carmen_scan({.ranges_m = ranges, .max_range_m = 20.0F}, out); }));
  EXPECT_THAT(std::vector(words.begin() + 9, words.begin() + 13),
              testing::ElementsAre("20.00", "20.00", "20.00", "1.5000"));
}

TEST(SlamText, TumLine_HasTheQuaternionOfTheYaw) {
  const stamped_pose pose{2'500'000'000, {1.0, -2.0, 2 * pi / 3}};
  const auto words = words_of(written([&](text_sink& out) { write_tum_pose(pose, out); }));
  ASSERT_EQ(words.size(), 8U);
  EXPECT_EQ(words[0], "2.500000");
  EXPECT_EQ(words[1], "1.000000");
  EXPECT_EQ(words[2], "-2.000000");
  EXPECT_EQ(words[3] + words[4] + words[5], "000");
  EXPECT_NEAR(std::stod(words[6]), std::sqrt(3.0) / 2, 1e-8);
  EXPECT_NEAR(std::stod(words[7]), 0.5, 1e-8);
}

point at(float angle_deg, float range_mm) {
  point p;
  p.angle_deg = angle_deg;
  p.range_mm = range_mm;
  return p;
}

TEST(SlamText, Carmen_OfALidarWithItsTopDown) {
  // Bins at -180, -90, 0 and 90 degrees of the robot; the lidar sees a return on its right, which is left of the robot.
  const std::vector<point> points{at(0.0F, 1000.0F), at(270.0F, 2000.0F), at(180.0F, 3000.0F)};
  const auto line = [&](const mounting& mount) {
    scan_record record;
    record.scan.points = points;
    record.time_ns = 5'000'000'000;
    record.robot = {4.0, 2.0, 0.0};
    return words_of(
        written([&](text_sink& out) { make_carmen_writer(4, mount)->write_scan(record, out); }));
  };
  const auto ranges = [](const std::vector<std::string>& words) {
    return std::vector(words.begin() + 9, words.begin() + 13);
  };
  EXPECT_THAT(ranges(line({})), testing::ElementsAre("1.0000", "2.0000", "3.0000", "30.00"));
  const auto down = line({.pose = {0.5, 0.0, 0.0}, .upside_down = true});
  EXPECT_THAT(ranges(down), testing::ElementsAre("1.0000", "30.00", "3.0000", "2.0000"));
  EXPECT_EQ(down.at(14), "4.500000");
  EXPECT_EQ(down.at(17), "4.000000");
}

TEST(SlamText, Tum_IsTheRobotAtEachRevolution) {
  scan_record record;
  record.time_ns = 3'000'000'000;
  record.robot = {1.5, -0.5, 0.0};
  const auto words =
      words_of(written([&](text_sink& out) { make_tum_writer()->write_scan(record, out); }));
  EXPECT_THAT(words, testing::ElementsAre("3.000000", "1.500000", "-0.500000", "0", "0", "0",
                                          "0.000000000", "1.000000000"));
}

}  // namespace
}  // namespace g4lidar
