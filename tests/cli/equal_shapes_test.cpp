// SPDX-License-Identifier: MIT
// The library shapes a drive as g4-dump convert does, bit for bit. The suites of C and Python compare theirs with convert,
// those of g4-ros2 and g4-serve with the library.
#include <array>
#include <cstdint>
#include <cstdio>
#include <sstream>
#include <string>

#include "g4lidar/scan_shaper.hpp"
#include "program.hpp"
#include "support/cloud_rows.hpp"
#include "support/shaped_drive.hpp"

namespace {

using g4lidar::deskewing;
using g4lidar::point;
using g4lidar::scan_shaper;
using g4lidar::test::shape_drive;

class EqualShapes : public cli::scratch {
 protected:
  static std::string bytes_of(const g4lidar::test::shaped_drive& drive, deskewing how) {
    std::string points;
    std::uint64_t not_deskewed = 0;
    shape_drive(drive, true, how, [&](scan_shaper& shaper, const g4lidar::scan& /*of*/) {
      const auto kept = shaper.kept();
      points.append(reinterpret_cast<const char*>(kept.data()), kept.points.size_bytes());
      not_deskewed = shaper.points_not_deskewed();
    });
    EXPECT_GT(not_deskewed, 1000U) << "of the first scans";
    EXPECT_LT(not_deskewed, 20'000U);
    return points;
  }
};

TEST_F(EqualShapes, OfTheLibrary) {
  const g4lidar::test::shaped_drive drive(G4_DUMP, path("."));
  const std::string points = bytes_of(drive, deskewing::by_scans);
  EXPECT_EQ(points.size(), drive.bytes().size());
  EXPECT_TRUE(points == drive.bytes());
}

TEST_F(EqualShapes, OfTheLibrary_ByOdometry) {
  const g4lidar::test::shaped_drive drive(G4_DUMP, path("."), "odometry");
  const std::string points = bytes_of(drive, deskewing::by_path);
  EXPECT_EQ(points.size(), drive.bytes().size());
  EXPECT_TRUE(points == drive.bytes());
}

TEST_F(EqualShapes, AsCsv) {
  const g4lidar::test::shaped_drive drive(G4_DUMP, path("."));
  std::istringstream csv(drive.converted("csv"));
  std::string line;
  std::getline(csv, line);  // the names of the columns
  shape_drive(
      drive, true, deskewing::by_scans, [&](scan_shaper& shaper, const g4lidar::scan& /*of*/) {
        for (const point& p : shaper.kept()) {
          std::array<char, 96> row{};
          std::snprintf(row.data(), row.size(), ",%.6f,%.2f,%lld", static_cast<double>(p.angle_deg),
                        static_cast<double>(p.range_mm), static_cast<long long>(p.time_ns));
          ASSERT_TRUE(std::getline(csv, line));
          ASSERT_EQ(line.substr(line.find(',')), row.data());
        }
      });
  EXPECT_FALSE(std::getline(csv, line)) << line;
}

}  // namespace
