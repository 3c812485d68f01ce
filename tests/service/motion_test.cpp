// SPDX-License-Identifier: MIT
// The motion of a robot: its odometry, and places in which the points are at the walls.
#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "service_bench.hpp"

namespace g4lidar::test {
namespace {

constexpr double quarter = std::numbers::pi / 2;
const mounting on_robot{{0.3, 0.1, quarter}, false};

/// A robot that drives along x, by 0.25 m a second from -1.5 m on.
double x_at(std::int64_t time_ns) { return -1.5 + 0.25 * static_cast<double>(time_ns) * 1e-9; }

class ServiceMotion : public Service {
 protected:
  static std::string drive() {
    std::string text(room);
    text += "mount 0.3,0.1,90\n";
    for (int i = 0; i < 15; ++i)
      text += "pose " + std::to_string(i) + " " + std::to_string(x_at(i * second)) + " 0 0\n";
    return text;
  }
  /// The same in real time; its odometry begins with 0,0,0.
  std::string driving(const std::string& more = "") {
    return "sim:?world=" + text_file("drive.txt", drive()) + more;
  }
  /// The same as a recording, with its odometry.
  const std::string& driven(bool has_odometry = true) {
    auto writer = recording_writer::create(file_.text());
    EXPECT_TRUE(writer);
    writer->set_wall_clock(recorded_ahead_ns);
    virtual_bench bench;
    bench.device = sim::device(std::get<sim::world>(sim::parse_world(drive())));
    auto device = lidar::open(*recorded(std::make_unique<virtual_connector>(bench), *writer));
    EXPECT_TRUE(device && device->start());
    for (std::int64_t next_ns = second; bench.now_ns < 9 * second;) {
      static_cast<void>(device->try_scan(std::chrono::milliseconds(500)));
      for (; has_odometry && next_ns < bench.now_ns; next_ns += second / 50)
        writer->odometry({next_ns, {x_at(next_ns), 0, 0}, {0.25, 0, 0}});
    }
    return file_.text();
  }
  static bool is_at_walls(const seen_scan& each, const pose_2d& map = {}) {
    return most_of(distances_to_walls(each.kept, map * each.about.place->pose)) < 0.03;
  }
  /// By a recording the robot is where it was.
  void expect_at_walls(std::size_t least) const {
    std::size_t count = 0;
    for (const seen_scan& each : heard.scans) {
      if (!each.about.place) continue;
      EXPECT_EQ(each.about.place->map, heard.scans.back().about.place->map);
      EXPECT_TRUE(is_at_walls(each)) << count;
      ++count;
    }
    EXPECT_GE(count, least);
  }

 private:
  temporary_path file_;
};

TEST_F(ServiceMotion, OfARecording_PlacesAreThoseOfItsOdometry) {
  play(driven(), {.follows_motion = true}, on_robot);
  EXPECT_TRUE(service->has_odometry());
  expect_at_walls(40);
  for (const seen_scan& each : heard.scans) {
    if (!each.about.place) continue;
    const std::int64_t recorded_ns = each.about.stamp_ns(each.about.first_ns) - recorded_ahead_ns;
    const pose_2d& found = each.about.place->pose;
    EXPECT_NEAR(found.x_m, x_at(recorded_ns) + 0.3, 0.001);
    EXPECT_NEAR(found.y_m, 0.1, 0.001);
    EXPECT_NEAR(found.yaw_rad, quarter, 0.001);
  }
  ASSERT_GT(heard.poses.size(), 300U);
  for (const auto& [pose, stamp_ns] : heard.poses) {
    EXPECT_NEAR(pose.pose.x_m, x_at(stamp_ns - recorded_ahead_ns), 1e-6);
    EXPECT_NEAR(pose.twist.x_m_per_s, 0.25, 1e-6);
  }
}

TEST_F(ServiceMotion, OfARecordingWithoutAMount_ItIsNotKnown) {
  play(driven(), {.follows_motion = true, .gives_points = true});
  ASSERT_GT(heard.scans.size(), 40U);
  for (const seen_scan& each : heard.scans) EXPECT_FALSE(each.about.place);
}

TEST_F(ServiceMotion, IsOnlyFollowedIfThatIsWanted_OdometryIsGivenNevertheless) {
  play(driven(), {.gives_points = true}, on_robot);
  EXPECT_TRUE(service->has_odometry());
  for (const seen_scan& each : heard.scans) EXPECT_FALSE(each.about.place);
  EXPECT_GT(heard.poses.size(), 300U);
}

TEST_F(ServiceMotion, OfARecordingThatBeginsAgain_ItIsAnotherMap) {
  service_lidar one = lidar_at(driven(), "", on_robot);
  one.options.playback.loop = true;
  begin({one}, {.follows_motion = true});
  ASSERT_TRUE(heard.wait_for_scans(100));  // a round has less than 60
  service->stop();
  std::set<std::uint32_t> maps;
  for (const seen_scan& each : heard.scans) {
    if (!each.about.place) continue;
    maps.insert(each.about.place->map);
    EXPECT_TRUE(is_at_walls(each));
  }
  EXPECT_GE(maps.size(), 2U);
}

TEST_F(ServiceMotion, OfASimulatedRobot_WithItsOwnMount) {
  begin(driving(), {.follows_motion = true});
  // Its odometry begins where it begins. It drives for 3.5 m; a busy machine reads some scans late.
  std::size_t seen = 0;
  int at_walls = 0;  // more than elsewhere
  ASSERT_TRUE(heard.wait([&] {
    for (; seen < heard.scans.size(); ++seen) {
      const seen_scan& each = heard.scans[seen];
      if (!each.about.place || each.about.place->pose.x_m > 3.4) continue;
      at_walls += is_at_walls(each, {-1.5, 0, 0}) ? 1 : -1;
    }
    return at_walls >= 10;
  })) << at_walls;
  service->stop();
  EXPECT_TRUE(service->has_odometry());
  // It speeds up until the second pose of its way.
  const auto [first, first_stamp_ns] = *std::ranges::find_if(
      heard.poses, [](const auto& each) { return each.first.pose.x_m > 0.25; });
  for (const auto& [pose, stamp_ns] : heard.poses) {
    EXPECT_LT(std::abs((stamp_ns - pose.time_ns) - (first_stamp_ns - first.time_ns)), second);
    if (pose.time_ns < first.time_ns) continue;
    const double seconds = static_cast<double>(pose.time_ns - first.time_ns) * 1e-9;
    EXPECT_NEAR(pose.pose.x_m, first.pose.x_m + 0.25 * seconds, 1e-5);
  }
}

TEST_F(ServiceMotion, OfALidarThatStands_IsNotKnown) {
  begin("sim:?seed=2", {.follows_motion = true});
  ASSERT_TRUE(heard.wait_for_scans(2));
  service->stop();
  EXPECT_FALSE(service->has_odometry());
  EXPECT_FALSE(heard.scans.back().about.place);
  EXPECT_TRUE(heard.poses.empty());
}

TEST_F(ServiceMotion, ByTheScans_ItIsKnownAfterTheFirstOnes) {
  play(driven(), {.deskew = deskewing::by_scans}, on_robot);
  ASSERT_TRUE(heard.scans.back().about.place);
  EXPECT_FALSE(heard.scans.front().about.place);
  std::size_t first = 0;
  while (!heard.scans[first].about.place) ++first;
  // The lidar looks along y of the room, so that it moves to its right.
  const pose_2d begin = heard.scans[first].about.place->pose;
  const auto& last = heard.scans.back().about;
  const double seconds =
      static_cast<double>(last.first_ns - heard.scans[first].about.first_ns) * 1e-9;
  const pose_2d way = inverse(begin) * last.place->pose;
  EXPECT_NEAR(way.y_m, -0.25 * seconds, 0.1);
  EXPECT_NEAR(way.x_m, 0, 0.1);
  EXPECT_EQ(last.place->map, heard.scans[first].about.place->map);
}

/// Odometry of another program: the lidar stands at a place of its map.
TEST_F(ServiceMotion, OfAnotherProgram_WhereTheSourceStatesNone) {
  service_options options{.deskew = deskewing::by_path};
  options.other_odometry = [](odometry_path& into, const scan& found, std::int64_t ahead_ns) {
    EXPECT_EQ(ahead_ns, recorded_ahead_ns);
    for (const std::int64_t at : {found.time_ns(), found.end_ns()})
      into.add({at, {x_at(at - found.time_ns()), 0, 0}, {0.25, 0, 0}});
  };
  play(driven(false), std::move(options), on_robot);
  EXPECT_FALSE(service->has_odometry());
  ASSERT_GT(heard.scans.size(), 40U);
  for (const seen_scan& each : heard.scans) {
    ASSERT_TRUE(each.about.place);
    EXPECT_NEAR(each.about.place->pose.x_m, -1.5 + 0.3, 1e-6);
    EXPECT_NEAR(each.about.place->pose.y_m, 0.1, 1e-6);
  }
}

TEST_F(ServiceMotion, ThatOfAnotherProgramIsNotAsked_WhereTheSourceStatesOne) {
  service_options options{.deskew = deskewing::by_path};
  options.other_odometry = [](odometry_path&, const scan&, std::int64_t) { ADD_FAILURE(); };
  play(driven(), std::move(options), on_robot);
  expect_at_walls(40);
}

TEST_F(ServiceMotion, ThatIsMissing_IsReportedAfterSeveralScans_AndWhenItIsKnown) {
  std::size_t scans = 0;
  service_options options{.deskew = deskewing::by_path, .other_odometry_place = "on /odom"};
  options.other_odometry = [&](odometry_path& into, const scan& found, std::int64_t) {
    if (++scans <= 20) return;
    into.add({found.time_ns(), {}, {}});
    into.add({found.end_ns(), {}, {}});
  };
  heard.during_scan = [&] {
    if (scans == 20) {
      ASSERT_EQ(heard.motions.size(), 1U);
      EXPECT_FALSE(heard.motions[0].first);
      EXPECT_THAT(heard.motions[0].second, ::testing::HasSubstr("on /odom"));
      EXPECT_GE(heard.scans_at_motion, 2U);
      EXPECT_LE(heard.scans_at_motion, 10U);
      const auto found = service->motion_diagnosis();
      ASSERT_EQ(found.size(), 1U);
      EXPECT_EQ(found[0].level, diagnostic_level::warn);
    }
  };
  play(driven(false), std::move(options), on_robot);
  ASSERT_EQ(heard.motions.size(), 2U);
  EXPECT_TRUE(heard.motions[1].first);
  EXPECT_EQ(heard.motions[1].second, "");
  static_cast<void>(service->motion_diagnosis());
  EXPECT_EQ(service->diagnosis().back().level, diagnostic_level::ok);
}

}  // namespace
}  // namespace g4lidar::test
