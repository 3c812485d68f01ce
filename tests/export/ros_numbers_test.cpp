// SPDX-License-Identifier: MIT
// What programs need that fill messages of ROS themselves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
  EXPECT_FLOAT_EQ(numbers_of({.model = model_named("x4")}, 4).range_max_m, 16.383F);
  EXPECT_FLOAT_EQ(numbers_of({.model = model_named("x4"), .longest_mm = 65'535.0F}, 4).range_max_m,
                  65.535F);
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

TEST(LaserScan, TheLongestRangeOfTheHeaderIsThatOfNoReturn) {
  std::vector<float> ranges;
  std::vector<float> intensities;
  message_header header{.longest_mm = 65'535.0F};
  const std::vector<point> nothing{{.angle_deg = 0.0F, .flags = point_flags::no_return},
                                   {.angle_deg = 180.0F, .flags = point_flags::no_return}};
  const grid_options how{.no_return = no_return_as::max};
  fill_laser_scan(quarters(nothing, g4_model), header, 2, how, ranges, intensities);
  EXPECT_THAT(ranges, about({65.535F, 65.535F}));
  header.longest_mm = 0.0F;
  fill_laser_scan(quarters(nothing, g4_model), header, 2, how, ranges, intensities);
  EXPECT_THAT(ranges, about({16.38375F, 16.38375F})) << "65535 quarters of a millimetre";
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

}  // namespace
}  // namespace g4lidar::test
