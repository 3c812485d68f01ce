// SPDX-License-Identifier: MIT
// The path of a simulated robot: what commands and timed poses become, and how smooth it is.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "g4lidar/sim/random.hpp"
#include "g4lidar/sim/scanner.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4lidar;

constexpr std::int64_t second_ns = 1'000'000'000;
constexpr std::array coordinates{&sim::pose::x_m, &sim::pose::y_m, &sim::pose::heading_deg};

std::vector<sim::path_point> path_of(std::string_view text, const sim::pose& start = {}) {
  auto read = sim::parse_path(text, start);
  if (const auto* error = std::get_if<sim::world_error>(&read)) {
    ADD_FAILURE() << "line " << error->line << ": " << error->message;
    return {{}};
  }
  return std::get<std::vector<sim::path_point>>(std::move(read));
}

void expect_pose(const sim::pose& is, const sim::pose& wanted, double within) {
  EXPECT_NEAR(is.x_m, wanted.x_m, within);
  EXPECT_NEAR(is.y_m, wanted.y_m, within);
  EXPECT_NEAR(is.heading_deg, wanted.heading_deg, within);
}

// 1 m/s^2 up to 0.5 m/s takes half a second and 12.5 cm.
TEST(Path, ForwardAcceleratesCruisesAndStops) {
  const auto path = path_of("drive forward 5 0.5", {1.0, 2.0, 90.0});
  EXPECT_EQ(path.back().time_ns, 10 * second_ns + second_ns / 2);
  const auto at = [&](double s) { return sim::robot_at(path, std::llround(s * 1e9)); };
  expect_pose(at(0.0).at, {1.0, 2.0, 90.0}, 0.0);
  expect_pose(at(0.3).at, {1.0, 2.045, 90.0}, 1e-12);
  expect_pose(at(0.3).per_s, {0.0, 0.3, 0.0}, 1e-12);
  expect_pose(at(0.5).at, {1.0, 2.125, 90.0}, 1e-12);
  expect_pose(at(5.25).at, {1.0, 4.5, 90.0}, 1e-12);
  expect_pose(at(5.25).per_s, {0.0, 0.5, 0.0}, 1e-12);
  expect_pose(at(10.3).at, {1.0, 6.98, 90.0}, 1e-12);
  expect_pose(at(11.0).at, {1.0, 7.0, 90.0}, 1e-12);
  expect_pose(at(11.0).per_s, {}, 0.0);
}

TEST(Path, AShortWayNeverReachesTheSpeed) {
  const auto path = path_of("drive forward -0.01 5");
  EXPECT_EQ(path.back().time_ns, second_ns / 5);
  expect_pose(sim::robot_at(path, second_ns / 10).at, {-0.005, 0.0, 0.0}, 1e-12);
  EXPECT_NEAR(sim::robot_at(path, second_ns / 10).per_s.x_m, -0.1, 1e-12);
}

TEST(Path, TurnsOnTheSpot) {
  const auto path = path_of("drive turn -450 90", {1.0, 1.0, 30.0});
  EXPECT_EQ(path.back().time_ns, 5 * second_ns + second_ns / 2);
  expect_pose(sim::robot_at(path, second_ns).at, {1.0, 1.0, -37.5}, 1e-9);
  expect_pose(sim::robot_at(path, second_ns).per_s, {0.0, 0.0, -90.0}, 1e-9);
  expect_pose(path.back().robot.at, {1.0, 1.0, -420.0}, 1e-9);
}

TEST(Path, WaitsAndContinues) {
  const auto path = path_of("drive wait 1.5\ndrive turn 90 180\n");
  EXPECT_EQ(sim::robot_at(path, 3 * second_ns / 2), sim::moving_pose{});
  EXPECT_EQ(path.back().time_ns,
            2'914'213'562);  // a turn with acceleration alone: 2 sqrt(90 / 180) s
}

TEST(Path, AnArcIsPartOfACircle) {
  for (const double side : {1.0, -1.0}) {
    const auto path = path_of(side > 0.0 ? "drive arc 2 135 1.6" : "drive arc 2 -135 0.8");
    for (std::int64_t now = 0; now <= path.back().time_ns; now += 1'000'000) {
      const auto [at, per_s] = sim::robot_at(path, now);
      ASSERT_NEAR(std::hypot(at.x_m, at.y_m - side * 2.0), 2.0, 2e-6);
      // It looks along the circle, and moves where it looks.
      const double turn = std::atan2(at.x_m, side * (side * 2.0 - at.y_m));
      ASSERT_NEAR(side * turn * 180.0 / std::numbers::pi, at.heading_deg, 1e-3);
      const double heading = at.heading_deg * std::numbers::pi / 180.0;
      ASSERT_NEAR(per_s.y_m * std::cos(heading) - per_s.x_m * std::sin(heading), 0.0, 1e-3);
    }
    EXPECT_NEAR(path.back().robot.at.heading_deg, side * 135.0, 1e-9);
  }
}

TEST(Path, GoesThroughTimedPosesTheShorterWayRound) {
  const auto path = path_of(
      "pose 1 0 0 170\n"
      "pose 2.5 1 0 -170  # a turn by 20 degrees\n"
      "pose 4 1 2 100\n");
  expect_pose(sim::robot_at(path, 0).at, {0.0, 0.0, 170.0}, 0.0);
  expect_pose(sim::robot_at(path, 5 * second_ns / 2).at, {1.0, 0.0, 190.0}, 1e-12);
  expect_pose(sim::robot_at(path, 4 * second_ns).at, {1.0, 2.0, 100.0}, 1e-12);
  expect_pose(sim::robot_at(path, 99 * second_ns).at, {1.0, 2.0, 100.0}, 1e-12);
}

std::string random_poses(sim::random_stream& random) {
  std::string text;
  int ms = 0;
  for (int i = 0; i < 30; ++i) {
    ms += 700 + static_cast<int>(random.next() % 3000);
    const auto metres = [&] {
      return std::to_string(random.next() % 8) + "." + std::to_string(random.next() % 10);
    };
    text += "pose " + std::to_string(ms / 1000) + "." + std::to_string(1000 + ms % 1000).substr(1) +
            " " + metres() + " " + metres() + " " + std::to_string(random.next() % 361) + "\n";
  }
  return text;
}

// The speed is the derivative of the place, and has no step; there is none at the ends either.
TEST(Path, IsSmooth) {
  sim::random_stream random(3);
  for (int round = 0; round < test::scaled(20); ++round) {
    const auto path =
        round % 2 == 0
            ? path_of(random_poses(random))
            : path_of(
                  "drive forward 2 0.8\ndrive arc 1 90\ndrive turn -90 90\ndrive forward 1 0.3");
    constexpr std::int64_t step = 10'000;
    for (std::int64_t now = 0; now < path.back().time_ns + second_ns; now += 7'777'777) {
      const sim::moving_pose before = sim::robot_at(path, now - step);
      const sim::moving_pose here = sim::robot_at(path, now);
      const sim::moving_pose after = sim::robot_at(path, now + step);
      for (const auto coordinate : coordinates) {
        // Accelerations are below 100 m/s^2 and 10000 degrees/s^2.
        const double scale = coordinate == &sim::pose::heading_deg ? 100.0 : 1.0;
        const double slope = (after.at.*coordinate - before.at.*coordinate) / 2e-5;
        ASSERT_NEAR(slope, here.per_s.*coordinate, 2e-3 * scale);
        ASSERT_NEAR(after.per_s.*coordinate, here.per_s.*coordinate, 2e-3 * scale);
      }
    }
  }
}

TEST(Path, PassesNoPoseThatItTurnsBackAt) {
  sim::random_stream random(4);
  for (int round = 0; round < test::scaled(20); ++round) {
    const auto path = path_of(random_poses(random));
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      const std::int64_t length = path[i + 1].time_ns - path[i].time_ns;
      for (std::int64_t part = 0; part <= 50; ++part) {
        const sim::pose at = sim::robot_at(path, path[i].time_ns + length * part / 50).at;
        for (const auto coordinate : coordinates) {
          const double one = path[i].robot.at.*coordinate;
          const double other = path[i + 1].robot.at.*coordinate;
          ASSERT_GE(at.*coordinate, std::min(one, other) - 1e-9);
          ASSERT_LE(at.*coordinate, std::max(one, other) + 1e-9);
        }
      }
    }
  }
}

void expect_same(const sim::sent_packet& a, const sim::sent_packet& b) {
  ASSERT_TRUE(std::equal(a.data.begin(), a.data.end(), b.data.begin(), b.data.end()));
  ASSERT_EQ(a.samples.size(), b.samples.size());
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    ASSERT_EQ(a.samples[i].bearing_deg, b.samples[i].bearing_deg);
    ASSERT_EQ(a.samples[i].range_mm, b.samples[i].range_mm);
    ASSERT_EQ(a.samples[i].lidar, b.samples[i].lidar);
  }
}

// The prepared and the unprepared computation agree to the last bit.
TEST(Path, ARobotThatStandsSeesWhatAFixedLidarSees) {
  for (const sim::turning way : {sim::turning::clockwise, sim::turning::mirrored}) {
    for (int i = 0; i < test::scaled(12); ++i) {
      sim::world fixed = sim::built_in_world();
      fixed.lidar = {0.03 * i, -0.02 * i, -360.0 + 61.3 * i};
      sim::world standing = fixed;
      standing.path = path_of("drive wait 100", fixed.lidar);
      sim::scanner one(fixed, {});
      sim::scanner other(standing, {});
      one.set_turning(way);
      other.set_turning(way);
      for (int packet = 0; packet < 200; ++packet) {
        const sim::sent_packet from_one = one.next();
        expect_same(from_one, other.next());
        if (testing::Test::HasFailure()) return;
      }
    }
  }
}

}  // namespace
