// SPDX-License-Identifier: MIT
// The library shapes a drive as g4-dump convert does, bit for bit. The suites of C and Python compare theirs with convert,
// those of g4-ros2 and g4-serve with the library.
#include <chrono>
#include <string>

#include "g4lidar/lidar.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "program.hpp"
#include "support/cloud_rows.hpp"
#include "support/shaped_drive.hpp"

namespace {

class EqualShapes : public cli::scratch {};

TEST_F(EqualShapes, OfTheLibrary) {
  const g4lidar::test::shaped_drive drive(G4_DUMP, path("."));
  auto opened = g4lidar::lidar::open("file:" + drive.recording(), {.partial_scans = true});
  ASSERT_TRUE(opened && opened->start());
  g4lidar::scan_shaper shaper(g4lidar::test::drive_shaping());
  std::string points;
  while (const auto scan = opened->next_scan(std::chrono::milliseconds(500))) {
    shaper.shape(*scan);
    const auto kept = shaper.kept();
    points.append(reinterpret_cast<const char*>(kept.data()), kept.points.size_bytes());
  }
  EXPECT_EQ(points.size(), drive.bytes().size());
  EXPECT_TRUE(points == drive.bytes());
  EXPECT_GT(shaper.points_not_deskewed(), 1000U) << "of the first scan";
  EXPECT_LT(shaper.points_not_deskewed(), 20'000U);
}

}  // namespace
