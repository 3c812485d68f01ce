// SPDX-License-Identifier: MIT
// Odometry: exact without errors, and with the stated errors otherwise.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <variant>
#include <vector>

#include "g4lidar/sim/odometry.hpp"
#include "support/allocation_count.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4lidar;

constexpr double radian = std::numbers::pi / 180.0;

sim::world driving(std::string_view text, const sim::pose& start = {}) {
  sim::world world;
  world.lidar = start;
  world.path = std::get<std::vector<sim::path_point>>(sim::parse_path(text, start));
  return world;
}

constexpr std::string_view winding =
    "drive forward 2 0.8\ndrive arc 1 135\ndrive turn -200 90\ndrive forward -1\n";

sim::odometry_sample last_of(const sim::world& world, const sim::odometry_options& options) {
  sim::odometry odometry(world, options);
  sim::odometry_sample last{};
  while (odometry.next_ns() <= world.path.back().time_ns + 1'000'000'000) last = odometry.next();
  return last;
}

TEST(Odometry, WithoutErrorsIsTheTruePathFromItsBegin) {
  const sim::pose start{3.0, -1.0, 40.0};
  const sim::world world = driving(winding, start);
  sim::odometry odometry(world, {});
  for (int i = 0; i < 600; ++i) {
    const sim::odometry_sample sample = odometry.next();
    ASSERT_EQ(sample.time_ns, i * 20'000'000LL);
    const sim::pose truth = sim::robot_at(world.path, sample.time_ns).at;
    const double x = truth.x_m - start.x_m;
    const double y = truth.y_m - start.y_m;
    const double turn = -start.heading_deg * radian;
    ASSERT_NEAR(sample.x_m, std::cos(turn) * x - std::sin(turn) * y, 1e-12);
    ASSERT_NEAR(sample.y_m, std::sin(turn) * x + std::cos(turn) * y, 1e-12);
    ASSERT_NEAR(std::remainder(sample.yaw_rad - (truth.heading_deg - start.heading_deg) * radian,
                               2.0 * std::numbers::pi),
                0.0, 1e-12);
    ASSERT_LE(std::fabs(sample.yaw_rad), std::numbers::pi + 1e-12);
  }
}

TEST(Odometry, TheTwistIsThatOfTheRobot) {
  const sim::world world = driving("drive forward 4 0.5\ndrive turn 180 90\n", {0.0, 0.0, 77.0});
  sim::odometry odometry(world, {});
  EXPECT_EQ(odometry.next(), sim::odometry_sample{});
  for (int i = 0; i < 200; ++i) (void)odometry.next();
  const sim::odometry_sample forward = odometry.next();  // at 4 s
  EXPECT_NEAR(forward.forward_m_per_s, 0.5, 1e-9);
  EXPECT_NEAR(forward.left_m_per_s, 0.0, 1e-9);
  EXPECT_NEAR(forward.yaw_rad_per_s, 0.0, 1e-9);
  for (int i = 0; i < 280; ++i) (void)odometry.next();
  const sim::odometry_sample turning = odometry.next();  // at 9.6 s
  EXPECT_NEAR(turning.forward_m_per_s, 0.0, 1e-9);
  EXPECT_NEAR(turning.yaw_rad_per_s, 90.0 * radian, 1e-9);
}

TEST(Odometry, SlipIsAShareOfWayAndTurn) {
  sim::odometry_options options;
  options.way_slip = 0.05;
  options.turn_slip = -0.02;
  EXPECT_NEAR(last_of(driving("drive forward 4\n"), options).x_m, 4.2, 1e-9);
  EXPECT_NEAR(last_of(driving("drive turn 100\n"), options).yaw_rad, 98.0 * radian, 1e-9);
}

struct spread {
  double mean;
  double deviation;
};

template <class Value>
spread spread_of(int runs, const Value& value) {
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < runs; ++i) {
    const double x = value(static_cast<std::uint64_t>(i + 1));
    sum += x;
    squares += x * x;
  }
  const double mean = sum / runs;
  return {mean, std::sqrt(squares / runs - mean * mean)};
}

// Of 1000 runs; the bounds are four standard errors.
TEST(Odometry, NoiseHasTheStatedDeviationAtAnyRate) {
  const int runs = 1000;
  const sim::world way = driving("drive forward 4 0.5\n");
  const sim::world turn = driving("drive turn 360 90\n");
  for (const double rate_hz : {10.0, 100.0}) {
    sim::odometry_options options;
    options.rate_hz = rate_hz;
    options.way_noise = 0.03;
    options.turn_noise = 0.02;
    const spread ways = spread_of(runs, [&](std::uint64_t seed) {
      options.seed = seed;
      return last_of(way, options).x_m - 4.0;
    });
    EXPECT_NEAR(ways.mean, 0.0, 4.0 * 0.06 / std::sqrt(runs));
    EXPECT_NEAR(ways.deviation, 0.06, 4.0 * 0.06 / std::sqrt(2.0 * runs));
    const spread turns = spread_of(runs, [&](std::uint64_t seed) {
      options.seed = seed;
      return std::remainder(last_of(turn, options).yaw_rad / radian, 360.0);
    });
    EXPECT_NEAR(turns.mean, 0.0, 4.0 * 3.6 / std::sqrt(runs));
    EXPECT_NEAR(turns.deviation, 3.6, 4.0 * 3.6 / std::sqrt(2.0 * runs));
  }
}

TEST(Odometry, OfAFixedLidarIsZero) {
  sim::odometry_options options;
  options.way_noise = options.turn_noise = 0.05;
  sim::odometry odometry(sim::built_in_world(), options);
  for (int i = 0; i < 100; ++i) {
    sim::odometry_sample expected{};
    expected.time_ns = odometry.next_ns();
    ASSERT_EQ(odometry.next(), expected);
  }
}

TEST(Odometry, NextAllocatesNothing) {
  sim::odometry odometry(driving(winding), {});
  EXPECT_EQ(test::allocations_in([&] {
              for (int i = 0; i < 1000; ++i) (void)odometry.next();
            }),
            0U);
}

TEST(Odometry, RefusesOptionsOutOfRange) {
  const auto problem = [](double sim::odometry_options::* member, double value) {
    sim::odometry_options options;
    options.*member = value;
    return !sim::problem_with(options).empty();
  };
  EXPECT_TRUE(sim::problem_with(sim::odometry_options{}).empty());
  EXPECT_TRUE(problem(&sim::odometry_options::rate_hz, 0.05));
  EXPECT_TRUE(problem(&sim::odometry_options::rate_hz, std::nan("")));
  EXPECT_TRUE(problem(&sim::odometry_options::way_noise, -0.1));
  EXPECT_TRUE(problem(&sim::odometry_options::turn_noise, 1.1));
  EXPECT_TRUE(problem(&sim::odometry_options::way_slip, 0.6));
  EXPECT_TRUE(problem(&sim::odometry_options::turn_slip, -0.6));
}

}  // namespace
