// SPDX-License-Identifier: MIT
// Scans that g4-ros2 filters and deskews, and what it reports where the motion is not known.
#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "cli/program.hpp"
#include "diagnosis.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "lidar.hpp"
#include "subscriber.hpp"
#include "support/cloud_rows.hpp"
#include "support/shaped_drive.hpp"

namespace ros2 {
namespace {

using g4lidar::deskewing;

class DeskewedRobot : public cli::scratch {
 protected:
  test_domain domain_;
};

TEST_F(DeskewedRobot, WithoutOdometryNothingIsDeskewedAndThatIsReported) {
  const served_lidar lidar;
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan);
  diagnosis diagnostics(domain_);
  cli::program tool({lidar.path(), "--deskew", "odometry"});
  EXPECT_TRUE(comes_true([&] { return diagnostics["g4lidar: deskewing level"] == "1"; }));
  EXPECT_THAT(diagnostics["g4lidar: deskewing warning"],
              ::testing::HasSubstr("no odometry on /odom"));
  std::size_t seen = 0;
  EXPECT_TRUE(comes_true([&] { return (seen += scans.take()) > 10; }));
  const publisher<odometry_message> odometry(domain_, "/odom", dds::odometry);
  std::string name = "odom";
  auto due = std::chrono::steady_clock::now();
  EXPECT_TRUE(comes_true([&] {
    if (const auto now = std::chrono::steady_clock::now(); now >= due) {
      odometry_message here{};
      here.header.frame_id = here.child_frame_id = name.data();
      here.pose.pose.orientation.w = 1;
      const auto stamp =
          std::chrono::system_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
      here.header.stamp = {static_cast<std::int32_t>(stamp / 1'000'000'000),
                           static_cast<std::uint32_t>(stamp % 1'000'000'000)};
      odometry.write(here);
      due = now + std::chrono::milliseconds(20);
    }
    return diagnostics["g4lidar: deskewing level"] == "0";
  }));
  EXPECT_GT(std::atoi(diagnostics["points_not_deskewed"].c_str()), 5000);
  tool.send(SIGINT);
  const std::string err = tool.wait().err;
  const std::size_t first = err.find("no odometry on /odom");
  EXPECT_NE(first, std::string::npos) << err;
  EXPECT_EQ(err.rfind("no odometry on /odom"), first) << err;
}

TEST_F(DeskewedRobot, MergedLidarsWhoseScansDoNotShowTheMotion_AreNotDeskewedAndThatIsReported) {
  cli::write_file(path("post.txt"), "wall 2 -0.1 2 0.1\nlidar 0 0 0\n");  // too few returns
  subscriber<cloud_message> clouds(domain_, "/points", dds::point_cloud2);
  diagnosis diagnostics(domain_);
  cli::program tool({"front=sim:?world=" + path("post.txt"), "--merge", "--mount", "front=0,0,0",
                     "--deskew", "scans"});
  EXPECT_TRUE(comes_true([&] { return clouds.take() > 0; }));
  EXPECT_TRUE(comes_true([&] { return diagnostics["g4lidar: deskewing level"] == "1"; }));
  EXPECT_EQ(diagnostics["g4lidar: deskewing warning"],
            "points are not deskewed: the scans do not show the motion");
  EXPECT_TRUE(
      comes_true([&] { return std::atoi(diagnostics["points_not_deskewed"].c_str()) > 3000; }));
  tool.send(SIGINT);
}

class ShapedDrive : public DeskewedRobot,
                    public ::testing::WithParamInterface<std::pair<const char*, deskewing>> {};

TEST_P(ShapedDrive, IsThatOfTheLibrary_BitForBit) {
  const auto [by, how] = GetParam();
  const g4lidar::test::shaped_drive drive(G4_DUMP_TOOL, path("."), by);
  const auto expected = g4lidar::test::cloud_rows_of(drive, how);
  subscriber<cloud_message> clouds(domain_, "/points", dds::point_cloud2, {.depth = 1000});
  cli::program tool({drive.recording(), "--standby", "--speckle", "--edges", "--near", "--range",
                     "0.3:", "--deskew", by});
  std::vector<std::string> got;
  EXPECT_TRUE(comes_true([&] {
    clouds.take([&](const cloud_message& cloud) {
      got.emplace_back(reinterpret_cast<const char*>(cloud.data._buffer), cloud.data._length);
    });
    return got.size() >= expected.size();
  })) << got.size();
  ASSERT_EQ(got.size(), expected.size());
  auto cloud = got.begin();
  for (const std::string& rows : expected) {
    ASSERT_TRUE(g4lidar::test::without_times(*cloud++) == rows) << cloud - got.begin();
  }
  tool.send(SIGINT);
}
INSTANTIATE_TEST_SUITE_P(By, ShapedDrive,
                         ::testing::Values(std::pair("scans", deskewing::by_scans),
                                           std::pair("odometry", deskewing::by_path)),
                         [](const auto& of) { return std::string(of.param.first); });

TEST(OdometryPath, GoesOnForALittleWithTheLastVelocity) {
  constexpr std::int64_t ms = 1'000'000;
  g4lidar::odometry_path path;
  EXPECT_TRUE(path.until(100 * ms).empty());
  path.add({1000 * ms, {1, 0, 0}, {2, 0, 0}});
  path.add({1020 * ms, {1.04, 0, 0}, {2, 0, 0}});
  EXPECT_EQ(path.until(1010 * ms).size(), 2U);
  const auto guessed = path.until(1070 * ms);
  ASSERT_EQ(guessed.size(), 3U);
  EXPECT_EQ(guessed[2].time_ns, 1070 * ms);
  EXPECT_NEAR(guessed[2].pose.x_m, 1.14, 1e-12);
  EXPECT_EQ(path.until(1500 * ms).size(), 2U);  // too long ago
  path.add({1040 * ms, {1.08, 0, 0}, {2, 0, 0}});
  EXPECT_EQ(path.until(1040 * ms).size(), 3U);
  path.add({10 * ms, {0, 0, 0}, {}});  // another clock, or the recording again
  EXPECT_EQ(path.until(10 * ms).size(), 1U);
}

}  // namespace
}  // namespace ros2
