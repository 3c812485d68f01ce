// SPDX-License-Identifier: MIT
// Members of structures: each option has its effect, and each value is that of the simulated device.
#include <cmath>
#include <vector>

#include "c_handles.hpp"

namespace {

using namespace g4lidar_c_test;

constexpr std::int64_t second = 1'000'000'000;

/// The counts after five seconds with a fault.
g4lidar_counts counts_with(const char* setup, std::uint32_t* suspect_packets = nullptr) {
  const simulator device = simulate(setup);
  g4lidar_options options = defaults();
  options.pace = G4LIDAR_PACKETS;  // gaps are those between readings
  const lidar it = start_on(device, &options);
  const g4lidar_scan* scan = nullptr;
  while (g4lidar_simulator_get_state(device.get())->time_ns < 5 * second) {
    if (g4lidar_try_scan(it.get(), 1000, &scan, nullptr) != G4LIDAR_OK) continue;
    if (suspect_packets == nullptr) continue;
    EXPECT_GE(scan->suspect_samples, scan->suspect_packets);
    *suspect_packets += scan->suspect_packets;
  }
  return *g4lidar_get_counts(it.get());
}

TEST(CMembers, CountsOfFaults) {
  const g4lidar_counts healthy = counts_with("sim:?seed=5");
  EXPECT_GE(healthy.responses, 3U);  // identity, start, ...
  EXPECT_EQ(healthy.samples_lost + healthy.suspect_packets + healthy.command_retries, 0U);
  EXPECT_LT(healthy.largest_gap_ns, second / 50);
  EXPECT_GT(counts_with("sim:?seed=5&fault=flip*0.001").samples_lost, 100U);
  EXPECT_GT(counts_with("sim:?seed=5&fault=mute@0+300ms").command_retries, 0U);
  const std::int64_t gap_ns = counts_with("sim:?seed=5&fault=drop*1@3s+200ms").largest_gap_ns;
  EXPECT_NEAR(static_cast<double>(gap_ns), 2e8, 2e7);
  std::uint32_t of_scans = 0;
  const g4lidar_counts jolted = counts_with("sim:?seed=5&fault=jolt*0.05", &of_scans);
  EXPECT_GT(jolted.suspect_packets, 20U);
  EXPECT_GT(of_scans, 20U);
  EXPECT_LE(of_scans, jolted.suspect_packets);
}

TEST(CMembers, PiecesComeOnlyIfWished) {
  const auto first_flags = [](bool pieces) {
    const simulator device = simulate();
    g4lidar_options options = defaults();
    options.partial_scans = pieces;
    const lidar it = start_on(device, &options);
    const g4lidar_scan* scan = nullptr;
    EXPECT_EQ(g4lidar_try_scan(it.get(), 5000, &scan, nullptr), G4LIDAR_OK);
    EXPECT_EQ(scan->is_piece, pieces);
    const std::uint32_t revolution = scan->revolution;
    const std::uint32_t flags = scan->flags;
    EXPECT_EQ(g4lidar_try_scan(it.get(), 5000, &scan, nullptr), G4LIDAR_OK);
    EXPECT_EQ(scan->revolution, revolution + 1);
    EXPECT_EQ(scan->points[0].revolution, scan->revolution);
    EXPECT_NEAR(scan->measured_sample_rate_hz, 9000.0F, 90.0F);
    return flags;
  };
  EXPECT_EQ(first_flags(true) & G4LIDAR_START_MISSING, G4LIDAR_START_MISSING);
  EXPECT_EQ(first_flags(false), 0U);
}

TEST(CMembers, TruthOfARevolution) {
  const simulator device = simulate(nullptr,
                                    "wall -2 -2 2 -2\nwall 2 -2 2 2\nwall 2 2 -2 2\n"
                                    "wall -2 2 -2 -2\nlidar 0.5 0.25 30\n");
  const lidar it = start_on(device);
  scan_at_speed(it);
  std::vector<g4lidar_truth> truth(16'384);
  std::size_t count = 0;
  ASSERT_EQ(g4lidar_simulator_take_truth(device.get(), truth.data(), truth.size(), &count),
            G4LIDAR_OK);
  ASSERT_GT(count, 1000U);
  for (std::size_t i = 0; i < count; ++i) {
    const g4lidar_truth& each = truth[i];
    ASSERT_EQ(each.x_m, 0.5);
    ASSERT_EQ(each.y_m, 0.25);
    ASSERT_EQ(each.heading_deg, 30.0);
    ASSERT_TRUE(each.head_deg >= 0.0 && each.head_deg < 360.0);
    if (i == 0) continue;
    const bool begins = each.head_deg < truth[i - 1].head_deg;
    ASSERT_EQ(each.revolution, truth[i - 1].revolution + (begins ? 1 : 0)) << i;
  }
}

TEST(CMembers, NeighboursOfOutliers) {
  // A wall 2 m away, 1 degree between its returns: 3.5 cm. One return is 0.5 m nearer.
  std::vector<g4lidar_point> points(90);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].angle_deg = static_cast<float>(i);
    points[i].range_mm = i == 40 ? 1500.0F : 2000.0F;
    points[i].time_ns = 1;
  }
  g4lidar_outlier_options options;
  g4lidar_outlier_options_init(&options, sizeof options);
  const auto left_out = [&](auto member) {
    g4lidar_shaper_options by = shaper_defaults();
    by.*member = &options;
    return points.size() - shaped(by, points).size();
  };
  EXPECT_EQ(left_out(&g4lidar_shaper_options::speckle), 1U);
  options.near_m = 0.6F;
  EXPECT_EQ(left_out(&g4lidar_shaper_options::speckle), 0U);
  options.near_m = 0.01F;
  options.near_ratio = 0.01F;  // 2 cm at 2 m
  EXPECT_EQ(left_out(&g4lidar_shaper_options::speckle), points.size());
  options.near_ratio = 0.05F;
  options.near_count = 4;  // of two on each side: not at the ends, and not beside the one return
  EXPECT_EQ(left_out(&g4lidar_shaper_options::speckle), 1U + 2U + 2U + 4U);
  const std::size_t narrow = left_out(&g4lidar_shaper_options::edges);
  options.edge_window = 3;
  EXPECT_GE(left_out(&g4lidar_shaper_options::edges), narrow);
}

/// A point 3 m away at 2 s, as it was seen at 1 s; `moved` is the way since then.
g4lidar_point deskewed(float angle_deg, const g4lidar_pose& moved, const g4lidar_mounting& mount) {
  std::vector<g4lidar_point> points(2, at(angle_deg, 3000.0F, second));
  points[1].time_ns = 2 * second;
  const g4lidar_stamped_pose path[2]{{second, {0.0, 0.0, 0.0}}, {2 * second, moved}};
  g4lidar_shaper_options options = shaper_defaults();
  options.deskew = G4LIDAR_DESKEW_BY_PATH;
  options.mount = &mount;
  return shaped(options, points, path).at(1);
}

TEST(CMembers, TurnsAndMountings) {
  // What is ahead after a quarter turn to the left was to the left: clockwise from the cable, 180 and 90.
  g4lidar_mounting mount{};
  const g4lidar_point turned = deskewed(180.0F, {0.0, 0.0, std::acos(0.0)}, mount);
  EXPECT_NEAR(turned.angle_deg, 90.0F, 0.01F);
  EXPECT_NEAR(turned.range_mm, 3000.0F, 0.02F);
  // The robot moved to its left, where an upright lidar sees the point.
  EXPECT_NEAR(deskewed(90.0F, {0.0, 1.0, 0.0}, mount).range_mm, 4000.0F, 0.02F);
  mount.upside_down = true;
  EXPECT_NEAR(deskewed(90.0F, {0.0, 1.0, 0.0}, mount).range_mm, 2000.0F, 0.02F);
}

}  // namespace
