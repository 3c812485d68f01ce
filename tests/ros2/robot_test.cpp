// SPDX-License-Identifier: MIT
// A robot with several lidars, and its odometry.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/program.hpp"
#include "diagnosis.hpp"
#include "lidar.hpp"
#include "subscriber.hpp"

namespace ros2 {
namespace {

class Robot : public cli::scratch {
 protected:
  test_domain domain_;
};

struct place {
  double x;
  double y;
};

/// From -2 to 3, and from -1.5 to 1.2.
constexpr std::string_view small_room =
    "wall -2 -1.5 3 -1.5\nwall 3 -1.5 3 1.2\nwall 3 1.2 -2 1.2\nwall -2 1.2 -2 -1.5\n";

/// Which one, and how far away.
std::pair<int, double> nearest_wall(const place& at) {
  const std::array<double, 4> distances{std::fabs(at.x + 2), std::fabs(at.x - 3),
                                        std::fabs(at.y + 1.5), std::fabs(at.y - 1.2)};
  const auto* const least = std::ranges::min_element(distances);
  return {static_cast<int>(least - distances.begin()), *least};
}

std::vector<place> places_of(const cloud_message& cloud) {
  std::vector<place> made;
  for (std::size_t at = 0; at < cloud.data._length; at += cloud.point_step) {
    std::array<float, 2> xy{};
    std::memcpy(xy.data(), cloud.data._buffer + at, sizeof xy);
    made.push_back({static_cast<double>(xy[0]), static_cast<double>(xy[1])});
  }
  return made;
}

double seconds_of(const builtin_interfaces_msg_dds__Time_& stamp) {
  return stamp.sec + stamp.nanosec * 1e-9;
}

TEST_F(Robot, TwoLidarsAreInNamespaces) {
  const served_lidar front;
  const served_lidar rear;
  subscriber<scan_message> front_scans(domain_, "/front/scan", dds::laser_scan);
  subscriber<scan_message> rear_scans(domain_, "/rear/scan", dds::laser_scan);
  cli::program tool({"front=" + front.path(), "rear=" + rear.path()});
  std::string frame_id;
  EXPECT_TRUE(comes_true([&] {
    return front_scans.take([&](const scan_message& scan) { frame_id = scan.header.frame_id; }) > 0;
  }));
  EXPECT_EQ(frame_id, "front_laser");
  EXPECT_TRUE(comes_true([&] { return rear_scans.take() > 0; }));
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

TEST_F(Robot, ItsTimesGoOnWhereTheRecordingBeginsAgain) {
  const std::string file = path("way.mcap");
  cli::write_file(path("way.txt"), "drive forward 0.5 0.5\n");
  make_recording(file, 3, "--path " + path("way.txt") + " --odometry " + path("way.odo"),
                 "--odometry " + path("way.odo"));
  subscriber<odometry_message> odometry(domain_, "/odom", dds::odometry, {.depth = 5000});
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan, {.depth = 1000});
  subscriber<clock_message> clock(domain_, "/clock", dds::clock_message, {.depth = 1000});
  subscriber<diagnostic_message> diagnostics(domain_, "/diagnostics", dds::diagnostic_array);
  cli::program tool({file, "--standby", "--loop", "--playback-speed", "10"});
  std::vector<double> times;
  std::vector<double> ways;
  std::vector<double> clocks;
  std::vector<double> stamps;
  std::vector<double> reports;
  EXPECT_TRUE(comes_true(
      [&] {
        odometry.take([&](const odometry_message& at) {
          times.push_back(seconds_of(at.header.stamp));
          ways.push_back(at.pose.pose.position.x);
        });
        clock.take([&](const clock_message& now) { clocks.push_back(seconds_of(now.clock)); });
        scans.take([&](const scan_message& at) { stamps.push_back(seconds_of(at.header.stamp)); });
        diagnostics.take(
            [&](const diagnostic_message& at) { reports.push_back(seconds_of(at.header.stamp)); });
        return !times.empty() && times.back() - times.front() > 40 && !stamps.empty() &&
               !clocks.empty() && !reports.empty() && reports.back() - clocks.front() > 30;
      },
      std::chrono::seconds(60)));
  EXPECT_TRUE(std::ranges::is_sorted(times));
  EXPECT_TRUE(std::ranges::is_sorted(clocks, std::less_equal()));
  EXPECT_TRUE(std::ranges::is_sorted(stamps, std::less_equal()));
  EXPECT_TRUE(std::ranges::is_sorted(reports));
  EXPECT_NEAR(times.back(), stamps.back(), 3.0);
  // In each round it begins where it began.
  int beginnings = 0;
  for (std::size_t i = 1; i < ways.size(); ++i) beginnings += ways[i] < ways[i - 1] - 0.4 ? 1 : 0;
  EXPECT_GE(beginnings, 2);
  tool.send(SIGINT);
}

TEST_F(Robot, MergedLidarsSeeTheWallsWhereTheyAre) {
  // The direction of a lidar's cable is opposite to that of its mounting.
  cli::write_file(path("front.txt"), std::string(small_room) + "lidar 0.3 0.1 -160\n");
  cli::write_file(path("rear.txt"), std::string(small_room) + "lidar -0.4 -0.2 30\n");
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan);
  subscriber<cloud_message> clouds(domain_, "/points", dds::point_cloud2);
  diagnosis diagnostics(domain_);
  cli::program tool({"front=sim:?world=" + path("front.txt"), "rear=sim:?world=" + path("rear.txt"),
                     "--merge", "--mount", "front=0.3,0.1,20", "--mount", "rear=-0.4,-0.2,-150"});
  std::vector<place> points;
  EXPECT_TRUE(comes_true([&] {
    clouds.take([&](const cloud_message& cloud) {
      points = places_of(cloud);
      EXPECT_STREQ(cloud.header.frame_id, "base_link");
    });
    return points.size() > 2000;
  })) << points.size();
  std::map<int, int> walls;
  for (const place& at : points) {
    const auto [wall, distance_m] = nearest_wall(at);
    EXPECT_LT(distance_m, 0.06) << at.x << ' ' << at.y;
    ++walls[wall];
  }
  for (const int wall : {0, 1, 2, 3}) EXPECT_GT(walls[wall], 100) << wall;
  std::vector<float> ranges;
  EXPECT_TRUE(comes_true([&] {
    return scans.take([&](const scan_message& scan) {
      ranges.assign(scan.ranges._buffer, scan.ranges._buffer + scan.ranges._length);
    }) > 0;
  }));
  ASSERT_EQ(ranges.size(), 720U);
  int seen = 0;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double angle = (static_cast<double>(i) - 360.0) / 360.0 * std::numbers::pi;
    const double range = static_cast<double>(ranges[i]);
    if (!std::isfinite(range)) continue;
    ++seen;
    EXPECT_LT(nearest_wall({range * std::cos(angle), range * std::sin(angle)}).second, 0.08) << i;
  }
  EXPECT_GT(seen, 700);
  // A scan may be without a lidar that is still being opened; then none is.
  EXPECT_TRUE(comes_true([&] { return diagnostics["g4lidar: merging level"] == "0"; }));
  EXPECT_NE(diagnostics["scans_without_front"], "");
  EXPECT_NE(diagnostics["scans_without_rear"], "");
  tool.send(SIGINT);
}

TEST_F(Robot, MergedLidars_AWallThatIsTooNearForOneIsNoFreeWay) {
  // One drives to 0.15 m before a wall. The other one stands, and sees only what is behind it.
  cli::write_file(path("front.txt"),
                  "wall 1 -1.5 1 1.2\nwall 1 1.2 -2 1.2\nlidar 0 0 0\nmount 0,0,0\n"
                  "drive wait 1\ndrive forward 0.85 0.5\ndrive wait 1000\n");
  cli::write_file(path("rear.txt"), "wall -2 -1.5 -2 1.2\nlidar 0 0 0\n");
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan);
  cli::program tool({"front=sim:?world=" + path("front.txt"), "rear=sim:?world=" + path("rear.txt"),
                     "--merge", "--mount", "front=0,0,0", "--mount", "rear=0,0,180",
                     "--near=revolutions=0", "--near-as", "minus-inf"});
  std::vector<float> ranges(720);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(comes_true([&] {
    scans.take([&](const scan_message& scan) {
      ranges.assign(scan.ranges._buffer, scan.ranges._buffer + scan.ranges._length);
    });
    return ranges[360] == -infinity && ranges[0] > 0;
  })) << ranges[360];
  EXPECT_NEAR(static_cast<double>(ranges[540]), 1.2, 0.05);  // left
  EXPECT_NEAR(static_cast<double>(ranges[0]), 2.0, 0.05);    // behind
  EXPECT_EQ(ranges[180], infinity) << "nothing is there";
  tool.send(SIGINT);
}

/// A G4 measures no intensity, and longer ranges than a T-mini Pro, which does.
TEST_F(Robot, MergedLidars_HaveTheIntensitiesOfThoseThatMeasureThem) {
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan);
  subscriber<cloud_message> clouds(domain_, "/points", dds::point_cloud2);
  cli::program tool({"front=sim:", "rear=sim:?model=t-mini-pro", "--merge", "--mount",
                     "front=0,0,0", "--mount", "rear=0,0,180"});
  std::size_t with = 0;
  std::size_t without = 0;
  EXPECT_TRUE(comes_true([&] {
    clouds.take([&](const cloud_message& cloud) {
      if (cloud.fields._length != 7) return;  // the T-mini Pro has not begun
      EXPECT_STREQ(cloud.fields._buffer[6].name, "intensity");
      std::size_t bright = 0;
      for (std::size_t at = 0; at < cloud.data._length; at += cloud.point_step) {
        float intensity = 0.0F;
        std::memcpy(&intensity, cloud.data._buffer + at + 24, sizeof intensity);
        bright += intensity > 0.0F ? 1U : 0U;
      }
      with = bright;
      without = cloud.width - bright;
    });
    return with > 300 && without > 900;  // of 571 and 1286 samples
  })) << with
      << " and " << without;
  std::size_t bright = 0;
  std::size_t dark = 0;
  float range_max = 0.0F;
  EXPECT_TRUE(comes_true([&] {
    scans.take([&](const scan_message& scan) {
      if (scan.intensities._length == 0) return;
      EXPECT_EQ(scan.intensities._length, scan.ranges._length);
      const std::span all(scan.intensities._buffer, scan.intensities._length);
      dark = static_cast<std::size_t>(std::ranges::count(all, 0.0F));
      bright = all.size() - dark;
      range_max = scan.range_max;
    });
    return bright > 50 && dark > 50;
  })) << bright
      << " and " << dark;
  EXPECT_EQ(range_max, 16.0F) << "of the G4";
  tool.send(SIGINT);
}

}  // namespace
}  // namespace ros2
