// SPDX-License-Identifier: MIT
// What programs need that fill messages of ROS themselves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/message/ros_messages.hpp"

namespace g4lidar::test {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(LaserScan, NumbersForProgramsThatFillAMessageThemselves) {
  const laser_scan_numbers by_time =
      numbers_of({.duration_ns = 100'000'000, .order = scan_order::time, .first_bin = 3}, 4);
  EXPECT_EQ(by_time.first, 3U);
  EXPECT_NEAR(by_time.angle_min_rad, 1.57079633, 1e-6) << "3 of 4 bins after the cable, behind";
  EXPECT_NEAR(by_time.angle_max_rad, 6.28318531, 1e-6);
  EXPECT_FLOAT_EQ(by_time.time_increment_s, 0.025F);
  EXPECT_FLOAT_EQ(by_time.scan_time_s, 0.1F);
  EXPECT_EQ(numbers_of({.first_bin = 3}, 4).first, 0U) << "by angle";
}

TEST(LaserScan, TheLongestRangeIsThatOfTheHeader_ElseOfTheModel) {
  EXPECT_FLOAT_EQ(numbers_of({.model = model_named("x4")}, 4).range_max_m, 10.0F);
  EXPECT_FLOAT_EQ(numbers_of({.model = model_named("x4"), .longest_mm = 6000.0F}, 4).range_max_m,
                  6.0F);
}

/// These ranges, in metres.
::testing::Matcher<std::vector<float>> about(const std::vector<float>& ranges) {
  return ::testing::Pointwise(::testing::FloatNear(1e-5F), ranges);
}

/// Four returns of a model, a quarter of a turn apart: ahead first, clockwise.
scan quarters(const std::vector<point>& points, const model& which) {
  scan made;
  made.points = points;
  made.duration_ns = 400;
  made.model = &which;
  return made;
}

TEST(LaserScan, IsFilledInItsOrder_WithTheIntensitiesOfTheModel) {
  const model& with_intensity = *model_named("t-mini-pro");
  const std::vector<point> points{
      {.angle_deg = 0.0F, .range_mm = 1000.0F, .time_ns = 0, .intensity = 10},
      {.angle_deg = 90.0F, .range_mm = 2000.0F, .time_ns = 100, .intensity = 20},
      {.angle_deg = 180.0F, .range_mm = 3000.0F, .time_ns = 200, .intensity = 30},
      {.angle_deg = 270.0F, .range_mm = 4000.0F, .time_ns = 300, .intensity = 40}};
  std::vector<float> ranges(9);
  std::vector<float> intensities;
  message_header header{.first_bin = 3, .model = &with_intensity};
  fill_laser_scan(quarters(points, with_intensity), header, 4, {}, ranges, intensities);
  // By angle: behind, right, ahead, left, counter-clockwise, for a model whose zero is ahead or behind.
  const bool is_turned = with_intensity.turn_deg != 0;
  EXPECT_THAT(ranges,
              is_turned ? about({1.0F, 4.0F, 3.0F, 2.0F}) : about({3.0F, 2.0F, 1.0F, 4.0F}));
  EXPECT_THAT(intensities, is_turned ? ElementsAre(10.0F, 40.0F, 30.0F, 20.0F)
                                     : ElementsAre(30.0F, 20.0F, 10.0F, 40.0F));
  EXPECT_EQ(header.first_bin, 0U);
  EXPECT_EQ(header.intensities.data(), intensities.data());
  EXPECT_EQ(header.intensities.size(), 4U);

  message_header by_time{.order = scan_order::time};
  fill_laser_scan(quarters(points, g4_model), by_time, 4, {}, ranges, intensities);
  EXPECT_THAT(ranges, about({1.0F, 2.0F, 3.0F, 4.0F}));
  EXPECT_THAT(intensities, IsEmpty()) << "a G4 has none";
  EXPECT_TRUE(by_time.intensities.empty());
}

/// The limit of a filter, the model, and what range_max and a direction without return are then, in metres.
struct longest {
  float limit_mm;
  const char* model;
  float expected_m;
};

TEST(LaserScan, TheLongestRangeIsTheLimitOfTheFilter_WithinThatOfTheModel) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const std::vector<point> nothing{
      {.angle_deg = 0.0F, .flags = point_flags::no_return},
      {.angle_deg = 180.0F, .time_ns = 200, .flags = point_flags::no_return}};
  for (const auto& [limit_mm, word, expected_m] :
       {longest{0.0F, "g4", 16.0F}, longest{9000.0F, "g4", 9.0F}, longest{infinity, "g4", 16.0F},
        longest{100'000.0F, "x2", 8.0F}, longest{0.0F, "tg50", 50.0F},
        longest{20'000.0F, "tg50", 20.0F}, longest{std::nanf(""), "t-mini", 12.0F}}) {
    for (const scan_order order : {scan_order::angle, scan_order::time}) {
      std::vector<float> ranges;
      std::vector<float> intensities;
      const g4lidar::model& of = *model_named(word);
      message_header header{.order = order, .model = &of, .longest_mm = 1.0F};
      const grid_options how{.no_return = no_return_as::max, .longest_mm = limit_mm};
      fill_laser_scan(quarters(nothing, of), header, 2, how, ranges, intensities);
      EXPECT_THAT(ranges, about({expected_m, expected_m})) << word;
      EXPECT_FLOAT_EQ(numbers_of(header, 2).range_max_m, expected_m) << word;
    }
  }
}

TEST(Quaternion, OfATurnAboutZ_AndOfATopThatIsDown) {
  constexpr double half = 0.70710678118654752;
  constexpr double pi = 3.14159265358979324;
  EXPECT_THAT(quaternion_of({.pose = {.yaw_rad = pi / 2}}),
              ElementsAre(0.0, 0.0, DoubleNear(half, 1e-12), DoubleNear(half, 1e-12)));
  EXPECT_THAT(quaternion_of({.pose = {}, .upside_down = true}), ElementsAre(1.0, 0.0, 0.0, 0.0));
}

TEST(PointCloud2, FieldsForProgramsThatFillAMessageThemselves) {
  EXPECT_EQ(cloud_point_size(g4_model), 24U);
  EXPECT_EQ(cloud_fields(g4_model).back().name, "angle");
  ASSERT_NE(model_named("t-mini-pro"), nullptr);
  EXPECT_EQ(cloud_point_size(*model_named("t-mini-pro")), 28U);
  EXPECT_EQ(cloud_fields(*model_named("t-mini-pro")).back().name, "intensity");
  EXPECT_EQ(cloud_fields(*model_named("t-mini-pro")).back().datatype, 7) << "FLOAT32";
}

// In a scan turned by a motion, or merged from several lidars, the earliest point may be anywhere; 0 is no time.
TEST(PointCloud2, BeginsAtTheEarliestTime) {
  std::array<point, 4> points{};
  EXPECT_EQ(cloud_time_ns({}), 0);
  EXPECT_EQ(cloud_time_ns(points), 0);
  points[1].time_ns = 7'000'000'000;
  EXPECT_EQ(cloud_time_ns(points), 7'000'000'000);
  points[3].time_ns = 5'000'000'000;
  EXPECT_EQ(cloud_time_ns(points), 5'000'000'000);
  points[0].time_ns = -1;
  EXPECT_EQ(cloud_time_ns(points), -1);
}

}  // namespace
}  // namespace g4lidar::test
