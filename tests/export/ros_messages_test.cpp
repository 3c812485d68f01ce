// SPDX-License-Identifier: MIT
// ROS messages against a reader written from the CDR rules, and against bytes written by hand.
#include "g4lidar/message/ros_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "support/cdr_reader.hpp"
#include "support/laser_scan.hpp"

namespace g4lidar::test {
namespace {

using ::testing::ElementsAreArray;
using ::testing::HasSubstr;

TEST(LaserScan, IsTheseBytes) {
  std::vector<std::uint8_t> message;
  put_laser_scan(std::array<float, 1>{1.0F},
                 {.stamp_ns = 2'000'000'003, .frame_id = "ab", .duration_ns = 125'000'000},
                 message);
  const std::vector<std::uint8_t> expected{
      0,    1,    0,    0,                             // little-endian CDR
      2,    0,    0,    0,    3,    0,    0,    0,     // 2 s, 3 ns
      3,    0,    0,    0,    'a',  'b',  0,    0,     // "ab" and its zero, to a multiple of 4
      0xDB, 0x0F, 0x49, 0xC0, 0xDB, 0x0F, 0x49, 0xC0,  // from -pi to -pi
      0xDB, 0x0F, 0xC9, 0x40, 0,    0,    0,    0,     // in steps of 2 pi, of which the times are 0
      0,    0,    0,    0x3E,                          // 0.125 s
      0xCD, 0xCC, 0xCC, 0x3D, 0,    0,    0x80, 0x41,  // 0.1 m to 16 m
      1,    0,    0,    0,    0,    0,    0x80, 0x3F,  // one range: 1 m
      0,    0,    0,    0};                            // no intensities
  EXPECT_THAT(message, ElementsAreArray(expected));
}

TEST(LaserScan, IsReadByTheRulesOfCdr) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> ranges{0.5F, inf, std::nanf(""), 16.0F};
  std::vector<std::uint8_t> message{99, 99};  // appends
  put_laser_scan(ranges, {.stamp_ns = 1'700'000'000'123'456'789, .frame_id = "laser"}, message);
  message.erase(message.begin(), message.begin() + 2);
  const laser_scan read = read_laser_scan(message);
  EXPECT_EQ(read.seconds, 1'700'000'000);
  EXPECT_EQ(read.nanoseconds, 123'456'789U);
  EXPECT_EQ(read.frame_id, "laser");
  EXPECT_NEAR(read.angle_min, -3.14159265, 1e-6);
  EXPECT_NEAR(read.angle_max, 1.57079633, 1e-6);  // the last of four bins
  EXPECT_NEAR(read.increment, 1.57079633, 1e-6);
  EXPECT_EQ(read.time_increment, 0.0F);
  EXPECT_EQ(read.scan_time, 0.0F) << "not known how long it took";
  EXPECT_EQ(read.range_min, 0.1F);
  EXPECT_EQ(read.range_max, 16.0F);
  ASSERT_EQ(read.ranges.size(), 4U);
  EXPECT_EQ(read.ranges[0], 0.5F);
  EXPECT_EQ(read.ranges[1], inf);
  EXPECT_TRUE(std::isnan(read.ranges[2]));
  EXPECT_EQ(read.ranges[3], 16.0F);
  EXPECT_TRUE(read.intensities.empty());
}

/// SLAM programs compute the number of ranges from the angles, as slam_toolbox does in single precision, and reject a
/// message with another number.
void expect_angles_give(std::size_t bins, const message_header& header) {
  std::vector<std::uint8_t> message;
  put_laser_scan(std::vector<float>(bins, 1.0F), header, message);
  const laser_scan read = read_laser_scan(message);
  const float first = read.angle_min;
  const float last = read.angle_max;
  const float step = read.increment;
  ASSERT_EQ(std::lround((last - first) / step) + 1, static_cast<long>(bins)) << header.first_bin;
  ASSERT_NEAR((static_cast<double>(last) - static_cast<double>(first)) / static_cast<double>(step),
              static_cast<double>(bins) - 1, 0.01)
      << "far from the next number";
}

TEST(LaserScan, AnglesGiveTheNumberOfRanges) {
  for (std::size_t bins = 90; bins <= 4000; ++bins) {
    expect_angles_give(bins, {.frame_id = "laser"});
    for (const std::size_t first : {std::size_t{0}, std::size_t{1}, bins / 2, bins - 1}) {
      expect_angles_give(bins,
                         {.frame_id = "laser", .order = scan_order::time, .first_bin = first});
    }
  }
}

TEST(LaserScan, InTheOrderOfTime) {
  // Bins at 0, 90, 180, 270 degrees clockwise from behind; the revolution begins at 270.
  const std::vector<float> ranges{1.0F, 2.0F, 3.0F, 4.0F};
  std::vector<std::uint8_t> message;
  put_laser_scan(ranges,
                 {.stamp_ns = 5'000'000'000,
                  .frame_id = "laser",
                  .duration_ns = 200'000'000,
                  .order = scan_order::time,
                  .first_bin = 3},
                 message);
  const laser_scan read = read_laser_scan(message);
  EXPECT_EQ(read.seconds, 5);
  EXPECT_EQ(read.nanoseconds, 0U);
  EXPECT_EQ(read.frame_id, "laser");
  // 270 degrees clockwise from behind is to the right, which is y with z down.
  EXPECT_NEAR(read.angle_min, 1.57079633, 1e-6);
  EXPECT_NEAR(read.angle_max, 1.57079633 * 4, 1e-6);
  EXPECT_NEAR(read.increment, 1.57079633, 1e-6);
  EXPECT_NEAR(read.time_increment, 0.05, 1e-8);
  EXPECT_NEAR(read.scan_time, 0.2, 1e-7);
  EXPECT_EQ(read.range_min, 0.1F);
  EXPECT_EQ(read.range_max, 16.0F);
  EXPECT_THAT(read.ranges, ElementsAreArray({4.0F, 1.0F, 2.0F, 3.0F}));
}

/// A revolution of 360 points, one each degree, whose returns are 7 degrees behind the level direction, as those of the
/// device are; its range is its number in metres.
std::vector<point> turned_points() {
  std::vector<point> points(360);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto n = static_cast<float>(i);
    points[i] = {.angle_deg = i < 7 ? 353.0F + n : n - 7.0F,
                 .range_mm = 1000.0F * (n + 1.0F),
                 .time_ns = 7'000'000'000 + static_cast<std::int64_t>(i) * 400'000};
  }
  return points;
}
constexpr std::int64_t turn_ns = 360 * std::int64_t{400'000};

TEST(TimeGrid, RangesAreInTheOrderOfTheirTimes) {
  const std::vector<point> points = turned_points();
  std::vector<float> ranges(360);
  const std::size_t first = fill_time_grid(points, turn_ns, ranges);
  EXPECT_EQ(first, 353U);
  for (std::size_t i = 0; i < 360; ++i) {
    EXPECT_FLOAT_EQ(ranges[(first + i) % 360], static_cast<float>(i + 1)) << i;
  }
}

/// The first samples have no return, so their directions are not corrected.
TEST(TimeGrid, BeginsWhereTheReturnsBegin) {
  std::vector<point> points = turned_points();
  for (std::size_t i = 0; i < 200; ++i) {
    points[i].flags = point_flags::no_return;
    points[i].angle_deg = static_cast<float>(i);
    points[i].range_mm = 0.0F;
  }
  std::vector<float> ranges(360);
  EXPECT_EQ(fill_time_grid(points, turn_ns, ranges), 353U);
  EXPECT_FLOAT_EQ(ranges[195], 203.0F);
  EXPECT_EQ(ranges[5], std::numeric_limits<float>::infinity());
}

/// At the seam the corrections differ: the bin of a point may be that of the other end, a revolution earlier or later.
TEST(TimeGrid, LeavesOutWhatWouldGetTheTimeOfTheOtherEnd) {
  std::vector<point> points = turned_points();
  points[0].angle_deg = 351.0F;    // further back than where the revolution begins
  points[359].angle_deg = 355.0F;  // further ahead than where it ends
  std::vector<float> ranges(360);
  const std::size_t first = fill_time_grid(points, turn_ns, ranges);
  EXPECT_EQ(first, 353U);
  EXPECT_FLOAT_EQ(ranges[351], 359.0F) << "that of the end";
  EXPECT_FLOAT_EQ(ranges[355], 3.0F) << "that of the beginning";
  EXPECT_TRUE(std::isnan(ranges[352]));
  EXPECT_TRUE(std::isnan(ranges[353]));
}

TEST(TimeGrid, ADirectionWithoutReturn_BecomesWhatTheOptionSets) {
  std::vector<point> points = turned_points();
  points[100].flags = point_flags::no_return;
  points[200].flags = point_flags::no_return | point_flags::may_be_too_near;
  std::vector<float> ranges(360);
  static_cast<void>(fill_time_grid(points, turn_ns, ranges, {.no_return = no_return_as::max}));
  EXPECT_EQ(ranges[93], 16.0F);
  EXPECT_TRUE(std::isnan(ranges[193]));
  static_cast<void>(fill_time_grid(points, turn_ns, ranges, {.near_is_minus_infinity = true}));
  EXPECT_EQ(ranges[93], std::numeric_limits<float>::infinity());
  EXPECT_EQ(ranges[193], -std::numeric_limits<float>::infinity());
}

TEST(TimeGrid, OfNothingIsUnknown) {
  std::vector<float> ranges(4);
  EXPECT_EQ(fill_time_grid({}, 0, ranges), 0U);
  for (const float range : ranges) EXPECT_TRUE(std::isnan(range));
}

TEST(LaserScan, TimesBefore1970CountUpFromTheSecondBefore) {
  std::vector<std::uint8_t> message;
  put_laser_scan(std::array<float, 1>{1.0F}, {.stamp_ns = -1}, message);
  const laser_scan read = read_laser_scan(message);
  EXPECT_EQ(read.seconds, -1);
  EXPECT_EQ(read.nanoseconds, 999'999'999U);
}

TEST(PointCloud2, HoldsTheReturnsInTheRobotsFrame) {
  std::array<point, 4> points{};
  points[0] = {.angle_deg = 180.0F, .range_mm = 2000.0F, .time_ns = 5'000'000'000};  // ahead
  points[1] = {.angle_deg = 10.0F, .time_ns = 5'000'111'111, .flags = point_flags::no_return};
  points[2] = {.angle_deg = 90.0F, .range_mm = 500.0F, .time_ns = 5'000'222'222};   // left
  points[3] = {.angle_deg = 0.0F, .range_mm = 1000.0F, .time_ns = 20'000'000'000};  // behind
  std::vector<std::uint8_t> message;
  put_point_cloud2(points, {.stamp_ns = 7'000'000'000, .frame_id = "laser"}, message);
  cdr_reader read(message);
  EXPECT_EQ(read.number<std::int32_t>(), 7);
  EXPECT_EQ(read.number<std::uint32_t>(), 0U);
  EXPECT_EQ(read.text(), "laser");
  EXPECT_EQ(read.number<std::uint32_t>(), 1U);  // height
  EXPECT_EQ(read.number<std::uint32_t>(), 3U);  // width
  EXPECT_EQ(read.number<std::uint32_t>(), 6U);
  std::uint32_t offset = 0;
  for (const std::string name : {"x", "y", "z", "t", "range", "angle"}) {
    EXPECT_EQ(read.text(), name);
    EXPECT_EQ(read.number<std::uint32_t>(), offset);
    EXPECT_EQ(read.number<std::uint8_t>(), name == "t" ? 6 : 7);  // UINT32, FLOAT32
    EXPECT_EQ(read.number<std::uint32_t>(), 1U);
    offset += 4;
  }
  EXPECT_EQ(read.number<std::uint8_t>(), 0);  // is_bigendian
  EXPECT_EQ(read.number<std::uint32_t>(), 24U);
  EXPECT_EQ(read.number<std::uint32_t>(), 72U);
  EXPECT_EQ(read.number<std::uint32_t>(), 72U);
  const auto expect_point = [&read](double x_m, double y_m, std::uint32_t t_ns, double range_m,
                                    double angle_rad) {
    EXPECT_NEAR(read.number<float>(), x_m, 1e-6);
    EXPECT_NEAR(read.number<float>(), y_m, 1e-6);
    EXPECT_EQ(read.number<float>(), 0.0F);
    EXPECT_EQ(read.number<std::uint32_t>(), t_ns);
    EXPECT_NEAR(read.number<float>(), range_m, 1e-6);
    EXPECT_NEAR(read.number<float>(), angle_rad, 1e-6);
  };
  expect_point(2.0, 0.0, 0, 2.0, 0.0);
  expect_point(0.0, 0.5, 222'222, 0.5, 1.570796327);
  expect_point(-1.0, 0.0, 4'294'967'295U, 1.0, -3.141592654);  // 15 s do not fit
  EXPECT_EQ(read.number<std::uint8_t>(), 1);                   // is_dense
  EXPECT_TRUE(read.is_at_end());
}

TEST(PointCloud2, InTheFrameWithZDown) {
  const std::array<point, 1> points{{{.angle_deg = 135.0F,
                                      .range_mm = 2000.0F,
                                      .time_ns = 5'000'000'000}}};  // ahead, to the left
  std::vector<std::uint8_t> up;
  std::vector<std::uint8_t> down;
  put_point_cloud2(points, {.frame_id = "laser"}, up);
  put_point_cloud2(points, {.frame_id = "laser", .order = scan_order::time}, down);
  ASSERT_EQ(up.size(), down.size());
  const auto number = [](const std::vector<std::uint8_t>& message, std::size_t from_end) {
    float value = 0.0F;
    std::memcpy(&value, &message[message.size() - 1 - from_end], sizeof value);
    return value;
  };
  EXPECT_NEAR(number(up, 24), 1.41421356, 1e-6);
  EXPECT_NEAR(number(up, 20), 1.41421356, 1e-6);
  EXPECT_NEAR(number(up, 4), 0.785398163, 1e-6);
  EXPECT_NEAR(number(down, 24), 1.41421356, 1e-6);
  EXPECT_NEAR(number(down, 20), -1.41421356, 1e-6);
  EXPECT_NEAR(number(down, 4), -0.785398163, 1e-6);
}

TEST(Odometry, IsReadByTheRulesOfCdr) {
  std::vector<std::uint8_t> message;
  odometry_message what{.stamp_ns = 3'000'000'004,
                        .child_frame_id = "robot",
                        .pose = {1.5, -2.5, 1.5707963267948966},
                        .twist = {0.25, -0.125, 0.5}};
  what.pose_covariance[35] = 0.01;
  what.twist_covariance[0] = 0.02;
  put_odometry(what, message);
  cdr_reader read(message);
  EXPECT_EQ(read.number<std::int32_t>(), 3);
  EXPECT_EQ(read.number<std::uint32_t>(), 4U);
  EXPECT_EQ(read.text(), "odom");
  EXPECT_EQ(read.text(), "robot");
  const double half = 0.70710678118654752;
  for (const double value : {1.5, -2.5, 0.0, 0.0, 0.0, half, half}) {
    EXPECT_NEAR(read.number<double>(), value, 1e-12);
  }
  for (int i = 0; i < 36; ++i) EXPECT_EQ(read.number<double>(), i == 35 ? 0.01 : 0.0);
  for (const double value : {0.25, -0.125, 0.0, 0.0, 0.0, 0.5}) {
    EXPECT_EQ(read.number<double>(), value);
  }
  for (int i = 0; i < 36; ++i) EXPECT_EQ(read.number<double>(), i == 0 ? 0.02 : 0.0);
  EXPECT_TRUE(read.is_at_end());
}

TEST(TfMessage, IsReadByTheRulesOfCdr) {
  // The axes of a frame that is turned by 0.5 rad: y points the other way with the top down.
  for (const bool upside_down : {false, true}) {
    std::vector<std::uint8_t> message;
    put_tf_message({.stamp_ns = 3'000'000'004,
                    .child_frame_id = "lidar",
                    .place = {{0.5, 0.25, 0.5}, upside_down}},
                   message);
    cdr_reader read(message);
    EXPECT_EQ(read.number<std::uint32_t>(), 1U);
    EXPECT_EQ(read.number<std::int32_t>(), 3);
    EXPECT_EQ(read.number<std::uint32_t>(), 4U);
    EXPECT_EQ(read.text(), "base_link");
    EXPECT_EQ(read.text(), "lidar");
    for (const double value : {0.5, 0.25, 0.0}) EXPECT_EQ(read.number<double>(), value);
    const auto x = read.number<double>();
    const auto y = read.number<double>();
    const auto z = read.number<double>();
    const auto w = read.number<double>();
    EXPECT_TRUE(read.is_at_end());
    // The columns of the rotation's matrix: where the axes of the lidar point.
    const double left = upside_down ? -1.0 : 1.0;
    EXPECT_NEAR(1 - 2 * (y * y + z * z), std::cos(0.5), 1e-12);
    EXPECT_NEAR(2 * (x * y + z * w), std::sin(0.5), 1e-12);
    EXPECT_NEAR(2 * (x * y - z * w), -left * std::sin(0.5), 1e-12);
    EXPECT_NEAR(1 - 2 * (x * x + z * z), left * std::cos(0.5), 1e-12);
    EXPECT_NEAR(1 - 2 * (x * x + y * y), upside_down ? -1.0 : 1.0, 1e-12);
  }
}

TEST(PointCloud2, OfNothingHasNoPoints) {
  std::vector<std::uint8_t> message;
  put_point_cloud2({}, {}, message);
  EXPECT_EQ(message.back(), 1);
}

TEST(RosMessages, HaveTheirSchemas) {
  EXPECT_EQ(laser_scan_schema().name, "sensor_msgs/msg/LaserScan");
  EXPECT_THAT(std::string(laser_scan_schema().text), HasSubstr("\nfloat32[] intensities\n"));
  EXPECT_EQ(point_cloud2_schema().name, "sensor_msgs/msg/PointCloud2");
  EXPECT_THAT(std::string(point_cloud2_schema().text),
              HasSubstr("\nuint8[] data\nbool is_dense\n"));
  EXPECT_EQ(odometry_schema().name, "nav_msgs/msg/Odometry");
  EXPECT_EQ(tf_message_schema().name, "tf2_msgs/msg/TFMessage");
  // Each type that is used has its definition.
  for (const message_schema& schema :
       {laser_scan_schema(), point_cloud2_schema(), odometry_schema(), tf_message_schema()}) {
    std::istringstream lines{std::string(schema.text)};
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("MSG:") || line.find('/') == std::string::npos) continue;
      const std::string type = line.substr(0, line.find_first_of(" ["));
      EXPECT_THAT(std::string(schema.text), HasSubstr("\nMSG: " + type + "\n"));
    }
  }
}

}  // namespace
}  // namespace g4lidar::test
