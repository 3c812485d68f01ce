// SPDX-License-Identifier: MIT
// Coordinates, grids and twists in C.
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "c_handles.hpp"

namespace {

using namespace g4lidar_c_test;

TEST(CPoints, ToCoordinates) {
  const std::vector<g4lidar_point> points{at(90.0F, 2000.0F), at(180.0F, 1000.0F), at(0.0F, 0.0F)};
  std::vector<g4lidar_xy> xy(3);
  ASSERT_EQ(g4lidar_to_xy(points.data(), 3, G4LIDAR_VENDOR, 180, xy.data()), G4LIDAR_OK);
  EXPECT_NEAR(xy[0].x_m, 0.0F, 1e-6F);
  EXPECT_NEAR(xy[0].y_m, 2.0F, 1e-6F);
  EXPECT_NEAR(xy[1].x_m, -1.0F, 1e-6F);
  EXPECT_TRUE(std::isnan(xy[2].x_m) && std::isnan(xy[2].y_m));
  // The robot looks away from the cable: 180 degrees is ahead.
  ASSERT_EQ(g4lidar_to_xy(points.data(), 3, G4LIDAR_ROBOT, 180, xy.data()), G4LIDAR_OK);
  EXPECT_NEAR(xy[1].x_m, 1.0F, 1e-6F);
  EXPECT_NEAR(xy[0].y_m, 2.0F, 1e-6F);
  EXPECT_EQ(xy[0].time_ns, 1);
  std::vector<g4lidar_polar> polar(3);
  ASSERT_EQ(g4lidar_to_polar(points.data(), 3, G4LIDAR_ROBOT, 180, polar.data()), G4LIDAR_OK);
  EXPECT_NEAR(polar[0].bearing_rad, std::numbers::pi_v<float> / 2.0F, 1e-6F);
  EXPECT_NEAR(polar[0].range_m, 2.0F, 1e-6F);
  ASSERT_EQ(g4lidar_to_xy(points.data(), 3, G4LIDAR_ROBOT, 0, xy.data()), G4LIDAR_OK);
  EXPECT_NEAR(xy[1].x_m, -1.0F, 1e-6F) << "a model that is not turned looks at its 0 degrees";
  EXPECT_NEAR(xy[0].y_m, -2.0F, 1e-6F);
  ASSERT_EQ(g4lidar_to_polar(points.data(), 3, G4LIDAR_ROBOT, 0, polar.data()), G4LIDAR_OK);
  EXPECT_NEAR(polar[0].bearing_rad, -std::numbers::pi_v<float> / 2.0F, 1e-6F);
  EXPECT_EQ(g4lidar_to_polar(points.data(), 3, G4LIDAR_ROBOT, 90, polar.data()),
            G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_to_xy(points.data(), 3, G4LIDAR_ROBOT, 90, xy.data()), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_to_xy(points.data(), 3, 2, 180, xy.data()), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_to_xy(nullptr, 0, G4LIDAR_ROBOT, 180, nullptr), G4LIDAR_OK);
}

TEST(CPoints, FillAGrid) {
  const std::vector<g4lidar_point> points{at(0.0F, 1000.0F), at(1.0F, 900.0F), at(90.0F, 0.0F),
                                          at(180.0F, 50.0F)};
  std::vector<float> ranges(4);
  g4lidar_grid_options options;
  g4lidar_grid_options_init(&options, sizeof options);
  EXPECT_EQ(options.frame, G4LIDAR_ROBOT);
  options.frame = G4LIDAR_VENDOR;
  ASSERT_EQ(g4lidar_fill_grid(points.data(), 4, &options, ranges.data(), 4), G4LIDAR_OK);
  EXPECT_EQ(ranges[0], 1.0F);  // the nearest to the middle
  EXPECT_EQ(ranges[1], std::numeric_limits<float>::infinity());
  EXPECT_TRUE(std::isnan(ranges[2]));
  EXPECT_TRUE(std::isnan(ranges[3]));
  options.pick = G4LIDAR_MINIMUM;
  options.keep_too_near = true;
  ASSERT_EQ(g4lidar_fill_grid(points.data(), 4, &options, ranges.data(), 4), G4LIDAR_OK);
  EXPECT_NEAR(ranges[0], 0.9F, 1e-6F);
  EXPECT_NEAR(ranges[2], 0.05F, 1e-6F);
  // By default bin 0 is behind the robot, where the cable is.
  ASSERT_EQ(g4lidar_fill_grid(points.data(), 4, nullptr, ranges.data(), 4), G4LIDAR_OK);
  EXPECT_EQ(ranges[0], 1.0F);
  options.pick = 7;
  EXPECT_EQ(g4lidar_fill_grid(points.data(), 4, &options, ranges.data(), 4), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_fill_grid(points.data(), 4, nullptr, ranges.data(), 0), G4LIDAR_BAD_ARGUMENT);
  options.pick = G4LIDAR_MINIMUM;
  options.turn_deg = 90;
  EXPECT_EQ(g4lidar_fill_grid(points.data(), 4, &options, ranges.data(), 4), G4LIDAR_BAD_ARGUMENT);
}

TEST(CPoints, NoReturnAndTooNear_AreWhatTheOptionsSet) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  // A return at 0.4 m; the same beam without return, whose direction is 3.1 degrees less; another one.
  std::vector<g4lidar_point> points{at(90.0F, 400.0F), at(86.9F, 0.0F), at(180.0F, 0.0F)};
  points[1].revolution = points[2].revolution = 1;
  points[1].flags |= G4LIDAR_MAY_BE_TOO_NEAR;
  g4lidar_grid_options options;
  g4lidar_grid_options_init(&options, sizeof options);
  options.frame = G4LIDAR_VENDOR;
  std::vector<float> ranges(4);
  const auto fill = [&] {
    return g4lidar_fill_grid(&points[1], 2, &options, ranges.data(), ranges.size());
  };
  ASSERT_EQ(fill(), G4LIDAR_OK);
  EXPECT_TRUE(std::isnan(ranges[1]));
  EXPECT_EQ(ranges[2], infinity);
  options.no_return = G4LIDAR_NO_RETURN_AS_MAX;
  options.near_is_minus_infinity = 1;
  ASSERT_EQ(fill(), G4LIDAR_OK);
  EXPECT_EQ(ranges[1], -infinity);
  EXPECT_EQ(ranges[2], 16.0F);
  options.longest_range_mm = 65535.0F;
  ASSERT_EQ(fill(), G4LIDAR_OK);
  EXPECT_EQ(ranges[2], 65.535F);
  options.no_return = G4LIDAR_NO_RETURN_AS_NAN;
  ASSERT_EQ(fill(), G4LIDAR_OK);
  EXPECT_TRUE(std::isnan(ranges[2]));
  options.no_return = 3;
  EXPECT_EQ(fill(), G4LIDAR_BAD_ARGUMENT);
}

}  // namespace
