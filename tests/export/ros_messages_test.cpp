// SPDX-License-Identifier: MIT
// ROS messages against a reader written from the CDR rules, and against bytes written by hand.
#include "g4lidar/export/ros_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "support/cdr_reader.hpp"

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
      0xCD, 0xCC, 0xCC, 0x3D, 0xEC, 0x11, 0x83, 0x41,  // 0.1 m to 16.38375 m
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
  cdr_reader read(message);
  EXPECT_EQ(read.number<std::int32_t>(), 1'700'000'000);
  EXPECT_EQ(read.number<std::uint32_t>(), 123'456'789U);
  EXPECT_EQ(read.text(), "laser");
  EXPECT_NEAR(read.number<float>(), -3.14159265, 1e-6);
  EXPECT_NEAR(read.number<float>(), 1.57079633, 1e-6);  // the last of four bins
  EXPECT_NEAR(read.number<float>(), 1.57079633, 1e-6);
  EXPECT_EQ(read.number<float>(), 0.0F);
  EXPECT_EQ(read.number<float>(), 0.0F) << "not known how long it took";
  EXPECT_EQ(read.number<float>(), 0.1F);
  EXPECT_EQ(read.number<float>(), 16.38375F);
  EXPECT_EQ(read.number<std::uint32_t>(), 4U);
  EXPECT_EQ(read.number<float>(), 0.5F);
  EXPECT_EQ(read.number<float>(), inf);
  EXPECT_TRUE(std::isnan(read.number<float>()));
  EXPECT_EQ(read.number<float>(), 16.0F);
  EXPECT_EQ(read.number<std::uint32_t>(), 0U);
  EXPECT_TRUE(read.is_at_end());
}

/// SLAM programs compute the number of ranges from the angles, as slam_toolbox does in single precision, and reject a
/// message with another number.
TEST(LaserScan, AnglesGiveTheNumberOfRanges) {
  for (std::size_t bins = 90; bins <= 4000; ++bins) {
    std::vector<std::uint8_t> message;
    put_laser_scan(std::vector<float>(bins, 1.0F), {.frame_id = "laser"}, message);
    cdr_reader read(message);
    static_cast<void>(read.number<std::int32_t>());
    static_cast<void>(read.number<std::uint32_t>());
    static_cast<void>(read.text());
    const auto first = read.number<float>();
    const auto last = read.number<float>();
    const auto step = read.number<float>();
    ASSERT_EQ(std::lround((last - first) / step), static_cast<long>(bins) - 1) << bins;
    ASSERT_NEAR(
        (static_cast<double>(last) - static_cast<double>(first)) / static_cast<double>(step),
        static_cast<double>(bins) - 1, 0.01)
        << "far from the next number";
  }
}

TEST(LaserScan, TimesBefore1970CountUpFromTheSecondBefore) {
  std::vector<std::uint8_t> message;
  put_laser_scan(std::array<float, 1>{1.0F}, {.stamp_ns = -1}, message);
  cdr_reader read(message);
  EXPECT_EQ(read.number<std::int32_t>(), -1);
  EXPECT_EQ(read.number<std::uint32_t>(), 999'999'999U);
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
  EXPECT_EQ(read.number<std::uint32_t>(), 4U);
  std::uint32_t offset = 0;
  for (const std::string name : {"x", "y", "z", "t"}) {
    EXPECT_EQ(read.text(), name);
    EXPECT_EQ(read.number<std::uint32_t>(), offset);
    EXPECT_EQ(read.number<std::uint8_t>(), name == "t" ? 6 : 7);  // UINT32, FLOAT32
    EXPECT_EQ(read.number<std::uint32_t>(), 1U);
    offset += 4;
  }
  EXPECT_EQ(read.number<std::uint8_t>(), 0);  // is_bigendian
  EXPECT_EQ(read.number<std::uint32_t>(), 16U);
  EXPECT_EQ(read.number<std::uint32_t>(), 48U);
  EXPECT_EQ(read.number<std::uint32_t>(), 48U);
  const auto expect_point = [&read](double x_m, double y_m, std::uint32_t t_ns) {
    EXPECT_NEAR(read.number<float>(), x_m, 1e-6);
    EXPECT_NEAR(read.number<float>(), y_m, 1e-6);
    EXPECT_EQ(read.number<float>(), 0.0F);
    EXPECT_EQ(read.number<std::uint32_t>(), t_ns);
  };
  expect_point(2.0, 0.0, 0);
  expect_point(0.0, 0.5, 222'222);
  expect_point(-1.0, 0.0, 4'294'967'295U);    // 15 s do not fit
  EXPECT_EQ(read.number<std::uint8_t>(), 1);  // is_dense
  EXPECT_TRUE(read.is_at_end());
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
}

}  // namespace
}  // namespace g4lidar::test
