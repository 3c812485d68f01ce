// SPDX-License-Identifier: MIT
// C shapes a drive as g4-dump convert does, bit for bit.
#include <string>

#include "c_handles.hpp"
#ifdef G4_DUMP
#include "support/shaped_drive.hpp"
#endif

namespace {

using namespace g4lidar_c_test;

TEST(CEqualShapes, ToThoseOfConvert) {
#ifndef G4_DUMP
  GTEST_SKIP() << "g4-dump is not built";
#else
  const scratch files;
  const g4lidar::test::shaped_drive drive(G4_DUMP, files.path("."));
  g4lidar_filter_options filter;
  g4lidar_outlier_options outliers;
  g4lidar_near_options near;
  g4lidar_shaper_options options;
  g4lidar_filter_options_init(&filter, sizeof filter);
  filter.least_range_mm = 300.0F;
  g4lidar_outlier_options_init(&outliers, sizeof outliers);
  g4lidar_near_options_init(&near, sizeof near);
  g4lidar_shaper_options_init(&options, sizeof options);
  options.filter = &filter;
  options.speckle = options.edges = &outliers;
  options.near_options = &near;
  options.deskew = G4LIDAR_DESKEW_BY_SCANS;
  g4lidar_shaper* made = nullptr;
  ASSERT_EQ(g4lidar_shaper_create(&options, &made, nullptr), G4LIDAR_OK);
  const shaper by(made);
  g4lidar_lidar* opened = nullptr;
  g4lidar_error why;
  const std::string source = "file:" + drive.recording();
  g4lidar_options opening = defaults();
  opening.device = source.c_str();
  opening.partial_scans = true;
  ASSERT_EQ(g4lidar_open_with(&opening, &opened, &why), G4LIDAR_OK) << why.message;
  const lidar player(opened);
  ASSERT_EQ(g4lidar_start(opened, &why), G4LIDAR_OK) << why.message;
  std::string points;
  const g4lidar_scan* scan = nullptr;
  while (g4lidar_try_scan(opened, 500, &scan, &why) == G4LIDAR_OK) {
    ASSERT_EQ(
        g4lidar_shaper_shape(made, scan->points, scan->point_count, scan->is_piece, nullptr, 0),
        G4LIDAR_OK);
    std::size_t count = 0;
    const g4lidar_point* const kept = g4lidar_shaper_kept(made, &count);
    points.append(reinterpret_cast<const char*>(kept), count * sizeof *kept);
  }
  EXPECT_EQ(points.size(), drive.bytes().size());
  EXPECT_TRUE(points == drive.bytes());
#endif
}

}  // namespace
