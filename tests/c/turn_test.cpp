// SPDX-License-Identifier: MIT
// Points of models with and without a turn: where the walls of the simulated room really are.
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "c_handles.hpp"

namespace {

using namespace g4lidar_c_test;

/// In the frame of the robot: ahead 1 m, to the left 2 m, behind 4 m, to the right 3 m.
const std::string room =
    "wall 1 -3 1 2\nwall 1 2 -4 2\nwall -4 2 -4 -3\nwall -4 -3 1 -3\nmount 0,0,0\nlidar 0 0 0\n";

class CTurn : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    device_ = simulate(("sim:?seed=3&model=" + std::string(GetParam())).c_str(), room.c_str());
    lidar_ = start_on(device_);
    scan_ = scan_at_speed(lidar_);
    ASSERT_NE(scan_, nullptr);
    ASSERT_STREQ(scan_->model, GetParam());
  }
  simulator device_;
  lidar lidar_;
  const g4lidar_scan* scan_ = nullptr;
};

INSTANTIATE_TEST_SUITE_P(Models, CTurn, testing::Values("x4", "g4", "scl", "t-mini-pro", "tg30"));

TEST_P(CTurn, Grids) {
  g4lidar_grid_options options;
  g4lidar_grid_options_init(&options, sizeof options);
  options.pick = G4LIDAR_MINIMUM;
  ASSERT_EQ(g4lidar_grid_options_set_model(&options, scan_->model), G4LIDAR_OK);
  EXPECT_EQ(options.turn_deg, scan_->turn_deg);
  EXPECT_EQ(options.longest_range_mm, scan_->longest_range_mm);
  float ranges_m[16];
  ASSERT_EQ(g4lidar_fill_grid(scan_->points, scan_->point_count, &options, ranges_m, 16),
            G4LIDAR_OK);
  EXPECT_NEAR(ranges_m[8], 1.0F, 0.05F);
  EXPECT_NEAR(ranges_m[12], 2.0F, 0.05F);
  EXPECT_NEAR(ranges_m[0], 4.0F, 0.05F);
  EXPECT_NEAR(ranges_m[4], 3.0F, 0.05F);
  EXPECT_EQ(g4lidar_grid_options_set_model(&options, "x44"), G4LIDAR_BAD_ARGUMENT);
  ASSERT_EQ(g4lidar_grid_options_set_model(&options, nullptr), G4LIDAR_OK);
  EXPECT_EQ(options.turn_deg, 180U);
  EXPECT_EQ(options.longest_range_mm, 16000.0F);
}

TEST(CTurn, OptionsOfAnOlderProgramHaveNoModel) {
  g4lidar_grid_options options;
  constexpr std::size_t earlier = offsetof(g4lidar_grid_options, turn_deg);
  g4lidar_grid_options_init(&options, earlier);
  EXPECT_EQ(g4lidar_grid_options_set_model(&options, "x4"), G4LIDAR_BAD_ARGUMENT);
}

TEST_P(CTurn, TheTwistOfTheScans) {
  const std::string hall =
      "wall 6 -3 6 2\nwall 6 2 -4 2\nwall -4 2 -4 -3\nwall -4 -3 6 -3\nmount 0,0,0\nlidar 0 0 0\n";
  const simulator device = simulate(("sim:?seed=3&model=" + std::string(GetParam())).c_str(),
                                    hall.c_str(), "drive forward 2 0.4\n");
  const lidar it = start_on(device);
  g4lidar_estimator* estimator = nullptr;
  ASSERT_EQ(g4lidar_estimator_create(&estimator, nullptr), G4LIDAR_OK);
  std::vector<double> speeds;
  for (int i = 0; i < 15; ++i) {
    const g4lidar_scan* scan = next_whole(it);
    ASSERT_NE(scan, nullptr);
    g4lidar_twist_estimate found{};
    ASSERT_EQ(g4lidar_estimator_add_of_model(estimator, scan->points, scan->point_count,
                                             scan->model, &found),
              G4LIDAR_OK);
    EXPECT_EQ(found.status == G4LIDAR_TWIST_FIRST_SCAN, i == 0);
    if (found.status != G4LIDAR_TWIST_KNOWN) continue;
    EXPECT_TRUE(found.known[0] && found.known[1] && found.known[2]);
    EXPECT_GT(found.covariance[0], 0.0);
    speeds.push_back(found.twist.x_m_per_s);
  }
  g4lidar_twist_estimate found{};
  EXPECT_EQ(
      g4lidar_estimator_add_of_model(estimator, scan_->points, scan_->point_count, "x44", &found),
      G4LIDAR_BAD_ARGUMENT);
  g4lidar_estimator_free(estimator);
  ASSERT_GT(speeds.size(), 3U);
  std::ranges::sort(speeds);
  EXPECT_GT(speeds[speeds.size() / 2], 0.25);
  EXPECT_LT(speeds[speeds.size() / 2], 0.6)
      << "the speed of a smooth path is up to half above its mean";
}

/// A wall 110 mm away is nearer than what an X4 measures reliably, and not than that of a T-mini Pro.
TEST(CTurn, NearReturnsAreThoseOfTheModel) {
  const auto has_returns = [](const char* model) {
    g4lidar_estimator* estimator = nullptr;
    EXPECT_EQ(g4lidar_estimator_create(&estimator, nullptr), G4LIDAR_OK);
    g4lidar_twist_estimate found{};
    for (std::int64_t scan = 0; scan < 2; ++scan) {
      std::vector<g4lidar_point> points;
      for (int i = 0; i < 400; ++i) {
        points.push_back(at(static_cast<float>(i) * 0.9F, 110.0F,
                            1'000'000'000 + scan * 100'000'000 + i * 250'000));
      }
      EXPECT_EQ(
          g4lidar_estimator_add_of_model(estimator, points.data(), points.size(), model, &found),
          G4LIDAR_OK);
    }
    g4lidar_estimator_free(estimator);
    return found.status != G4LIDAR_TWIST_TOO_FEW_RETURNS;
  };
  EXPECT_TRUE(has_returns("t-mini-pro"));
  EXPECT_TRUE(has_returns(nullptr)) << "a G4";
  EXPECT_FALSE(has_returns("x4"));
}

}  // namespace
