// SPDX-License-Identifier: MIT
// Odometry in time with points: that of a list, and that of a simulated robot, whose way is known.
#include "g4lidar/motion/odometry_feed.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "g4lidar/lidar_options.hpp"
#include "g4lidar/sim/setup.hpp"
#include "service/standby.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::int64_t ms = 1'000'000;

/// The times in milliseconds of what comes with points from `first_ms` to `last_ms`.
std::vector<std::int64_t> taken(odometry_feed& feed, std::int64_t first_ms, std::int64_t last_ms) {
  const std::vector<point> points{{.time_ns = first_ms * ms}, {.time_ns = last_ms * ms}};
  std::vector<std::int64_t> times;
  feed.follow(points, [&](const stamped_odometry& at) { times.push_back(at.time_ns / ms); });
  return times;
}

odometry_feed list_of(const std::vector<std::int64_t>& times_ms) {
  std::vector<stamped_odometry> all;
  for (const std::int64_t each : times_ms) all.push_back({each * ms, {}, {}});
  odometry_feed feed;
  feed.set(std::move(all));
  return feed;
}

TEST(OdometryFeed, GivesThePoseBeforeTheFirstPoint_AndThatAfterTheLast) {
  auto feed = list_of({0, 20, 40, 60, 80, 100});
  EXPECT_TRUE(feed.is_known());
  EXPECT_THAT(taken(feed, 30, 50), ElementsAre(20, 40, 60));
  EXPECT_THAT(taken(feed, 51, 59), IsEmpty()) << "each once";
  EXPECT_THAT(taken(feed, 61, 300), ElementsAre(80, 100));
  EXPECT_THAT(taken(feed, 301, 400), IsEmpty());
  EXPECT_EQ(feed.begun(), 1U);
}

TEST(OdometryFeed, BeginsAgain_WherePointsGoBack) {
  auto feed = list_of({0, 500, 1000, 1500});
  EXPECT_THAT(taken(feed, 900, 1100), ElementsAre(500, 1000, 1500));
  EXPECT_THAT(taken(feed, 850, 870), IsEmpty()) << "by the error of a clock";
  EXPECT_THAT(taken(feed, 600, 700), ElementsAre(500, 1000)) << "a seek";
  EXPECT_EQ(feed.begun(), 2U);
}

TEST(OdometryFeed, IsShifted) {
  auto feed = list_of({0, 20});
  feed.shift(1000 * ms);
  EXPECT_THAT(taken(feed, 1010, 1015), ElementsAre(1000, 1020));
}

TEST(OdometryFeed, WithoutOdometry_GivesNothing) {
  odometry_feed feed;
  feed.follow(nullptr);
  EXPECT_FALSE(feed.is_known());
  EXPECT_THAT(taken(feed, 0, 1000), IsEmpty());
  EXPECT_FALSE(feed.load_recording("/nonexistent.mcap"));
}

/// A simulated lidar on a robot that drives by 0.5 m a second.
class DrivingRobot : public testing::Test {
 protected:
  void SetUp() override {
    const std::string way = testing::TempDir() + "odometry_feed_way.txt";
    std::ofstream file(way);
    for (int i = 0; i < 10; ++i) file << "pose " << i << ' ' << 0.5 * i << " 0 0\n";
    file.close();
    const std::string name = "sim:?path=" + way;
    EXPECT_TRUE(has_simulated_robot(name));
    auto made = connector_for({.device = name});
    ASSERT_TRUE(made) << made.error().message();
    connector_ = *std::move(made);
    ASSERT_NE(simulation_of(*connector_), nullptr);
  }

  std::unique_ptr<connector> connector_;
};

TEST_F(DrivingRobot, GivesItsPoses_ByTheClockOfThePoints) {
  const sim::simulated_source& simulated = *simulation_of(*connector_);
  odometry_feed feed;
  feed.follow(&simulated);
  EXPECT_TRUE(feed.is_known());
  std::vector<stamped_odometry> found;
  const std::int64_t begin_ns = simulated.begin_ns + 2500 * ms;
  const std::vector<point> points{{.time_ns = begin_ns}, {.time_ns = begin_ns + 300 * ms}};
  feed.follow(points, [&](const stamped_odometry& at) { found.push_back(at); });
  ASSERT_GE(found.size(), 3U);
  EXPECT_LE(found.front().time_ns, begin_ns);
  EXPECT_GT(found[1].time_ns, begin_ns) << "of what was before, only the last one";
  EXPECT_GE(found.back().time_ns, begin_ns + 300 * ms);
  EXPECT_LT(found[found.size() - 2].time_ns, begin_ns + 300 * ms);
  for (const stamped_odometry& each : found) {
    const double seconds = static_cast<double>(each.time_ns - simulated.begin_ns) * 1e-9;
    EXPECT_NEAR(each.pose.x_m, 0.5 * seconds, 1e-6);
    EXPECT_NEAR(each.twist.x_m_per_s, 0.5, 1e-6);
  }
  // Opened again: its poses begin again.
  feed.follow(&simulated);
  found.clear();
  feed.follow(points, [&](const stamped_odometry& at) { found.push_back(at); });
  EXPECT_GE(found.size(), 3U);
  EXPECT_EQ(feed.begun(), 2U);
}

TEST(SimulatedRobot, OnlyOfASimulatedLidarThatMoves) {
  EXPECT_FALSE(has_simulated_robot("sim:"));
  EXPECT_FALSE(has_simulated_robot("sim:?seed=x"));
  EXPECT_FALSE(has_simulated_robot("/dev/ttyUSB0"));
  auto still = connector_for({.device = "sim:"});
  ASSERT_TRUE(still) << still.error().message();
  EXPECT_FALSE(robot_of(*simulation_of(**still)));
}

TEST(Standby, RestsThreeSecondsAfterTheLastNeed) {
  standby rule;
  const standby::time_point begin{100h};
  EXPECT_TRUE(rule.rests(false, begin)) << "nobody has come yet";
  EXPECT_FALSE(rule.rests(true, begin + 1s));
  EXPECT_FALSE(rule.rests(false, begin + 4s));
  EXPECT_TRUE(rule.rests(false, begin + 4s + 1ns));
  EXPECT_FALSE(rule.rests(true, begin + 5s));
  EXPECT_FALSE(rule.rests(true, begin + 100s));
}

}  // namespace
}  // namespace g4lidar::test
