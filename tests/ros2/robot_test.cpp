// SPDX-License-Identifier: MIT
// A robot with several lidars, and its odometry.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "cli/program.hpp"
#include "io/scan_shaper.hpp"
#include "lidar.hpp"
#include "subscriber.hpp"

namespace ros2 {
namespace {

class Robot : public cli::scratch {
 protected:
  test_domain domain_;
};

TEST_F(Robot, TwoLidarsInNamespacesOrAsOneScan) {
  const served_lidar front;
  const served_lidar rear;
  const std::vector<std::string> sources{"front=" + front.path(), "rear=" + rear.path()};
  {
    subscriber<scan_message> front_scans(domain_, "/front/scan", dds::laser_scan);
    subscriber<scan_message> rear_scans(domain_, "/rear/scan", dds::laser_scan);
    cli::program tool(sources);
    std::string frame_id;
    EXPECT_TRUE(comes_true([&] {
      return front_scans.take([&](const scan_message& scan) { frame_id = scan.header.frame_id; }) >
             0;
    }));
    EXPECT_EQ(frame_id, "front_laser");
    EXPECT_TRUE(comes_true([&] { return rear_scans.take() > 0; }));
    tool.send(SIGINT);
    tool.wait();
  }
  // Both are at the same place of the same room: turned by half a turn, the second one sees what is behind the
  // robot where the first one sees what is ahead.
  std::vector<std::string> words = sources;
  words.insert(words.end(), {"--merge", "--mount", "front=0,0,0", "--mount", "rear=0,0,180"});
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan);
  subscriber<cloud_message> clouds(domain_, "/points", dds::point_cloud2);
  cli::program tool(words);
  std::size_t most = 0;
  std::string frame_id;
  EXPECT_TRUE(comes_true([&] {
    clouds.take([&](const cloud_message& cloud) {
      most = std::max<std::size_t>(most, cloud.width);
      frame_id = cloud.header.frame_id;
    });
    return most > 1700;  // of two times 1286 samples
  })) << most;
  EXPECT_EQ(frame_id, "base_link");
  EXPECT_TRUE(comes_true([&] { return scans.take() > 0; }));
  tool.send(SIGINT);
}

TEST_F(Robot, ItsWayInARecordingWithTheTime) {
  const std::string file = path("walk.mcap");
  cli::write_file(path("way.txt"), "drive forward 0.5 0.5\n");
  make_recording(file, 3, "--path " + path("way.txt") + " --odometry " + path("way.odo"),
                 "--odometry " + path("way.odo"));
  subscriber<odometry_message> odometry(domain_, "/odom", dds::odometry, {.depth = 1000});
  subscriber<tf_message> frames(domain_, "/tf", dds::tf_message, {.depth = 1000});
  subscriber<clock_message> clock(domain_, "/clock", dds::clock_message, {.depth = 1000});
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan);
  cli::program tool({file, "--standby", "--deskew", "odometry"});
  double greatest_m = 0;
  double speed = 0;
  std::int64_t clock_s = 0;
  std::int64_t scan_s = 0;
  std::size_t transforms = 0;
  EXPECT_TRUE(comes_true([&] {
    odometry.take([&](const odometry_message& at) {
      greatest_m = std::max(greatest_m, at.pose.pose.position.x);
      speed = std::max(speed, at.twist.twist.linear.x);
      EXPECT_STREQ(at.child_frame_id, "base_link");
    });
    transforms += frames.take();
    clock.take([&](const clock_message& now) { clock_s = now.clock.sec; });
    scans.take([&](const scan_message& scan) { scan_s = scan.header.stamp.sec; });
    return greatest_m > 0.49 && scan_s != 0;
  })) << greatest_m;
  EXPECT_NEAR(speed, 0.5, 0.02);
  EXPECT_GT(transforms, 50U);
  EXPECT_NEAR(static_cast<double>(clock_s), static_cast<double>(scan_s), 3.0);
  tool.send(SIGINT);
}

TEST(OdometryPath, GoesOnForALittleWithTheLastVelocity) {
  constexpr std::int64_t ms = 1'000'000;
  g4_tool::odometry_path path;
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
