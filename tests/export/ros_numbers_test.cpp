// SPDX-License-Identifier: MIT
// What programs need that fill messages of ROS themselves.
#include <gtest/gtest.h>

#include "g4lidar/core/model.hpp"
#include "g4lidar/message/ros_messages.hpp"

namespace g4lidar::test {
namespace {

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
