// SPDX-License-Identifier: MIT
// Motion in the plane, against libm and against motion in many small steps.
#include "g4lidar/motion.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "support/test_scale.hpp"

namespace g4lidar {
namespace {

using real = long double;
constexpr double pi = std::numbers::pi;

void expect_near(const pose_2d& got, const pose_2d& expected, double tolerance) {
  EXPECT_NEAR(got.x_m, expected.x_m, tolerance);
  EXPECT_NEAR(got.y_m, expected.y_m, tolerance);
  EXPECT_NEAR(std::remainder(got.yaw_rad - expected.yaw_rad, 2.0 * pi), 0.0, tolerance);
}

/// The greatest difference from libm in `count` angles of up to `limit` radians.
double greatest_error(double limit, int count) {
  std::mt19937 source(7);
  std::uniform_real_distribution<double> any(-limit, limit);
  real greatest = 0.0L;
  for (int i = 0; i < test::scaled(count); ++i) {
    const double yaw = any(source);
    const rotation r = rotation_by(yaw);
    greatest =
        std::max(greatest, std::fabs(static_cast<real>(r.sine) - std::sin(static_cast<real>(yaw))));
    greatest = std::max(greatest,
                        std::fabs(static_cast<real>(r.cosine) - std::cos(static_cast<real>(yaw))));
  }
  return static_cast<double>(greatest);
}

TEST(Rotation, IsWithinItsBounds) {
  EXPECT_LE(greatest_error(0.01, 20'000), 1e-15);
  EXPECT_LE(greatest_error(10.0, 200'000), 1e-15);
  EXPECT_LE(greatest_error(1000.0, 20'000), 1e-15);
  EXPECT_LE(greatest_error(1e6, 200'000), 1e-15);
}

TEST(Rotation, IsExactAtZero_AndNearTheQuarters) {
  static_assert(rotation_by(0.0).sine == 0.0 && rotation_by(0.0).cosine == 1.0);
  for (int quarter = -9; quarter <= 9; ++quarter) {
    for (const double off : {-1e-9, 0.0, 1e-9}) {
      const double yaw = quarter * (pi / 2.0) + off;
      const rotation r = rotation_by(yaw);
      EXPECT_NEAR(r.sine, std::sin(yaw), 2e-15) << quarter;
      EXPECT_NEAR(r.cosine, std::cos(yaw), 2e-15) << quarter;
    }
  }
}

TEST(WrapRad, IsTheSameDirection_AtMostHalfATurn) {
  std::mt19937 source(8);
  for (const double limit : {1.0, 4.0, 20.0, 1e6}) {
    std::uniform_real_distribution<double> any(-limit, limit);
    for (int i = 0; i < test::scaled(2000); ++i) {
      const double yaw = any(source);
      const double wrapped = wrap_rad(yaw);
      EXPECT_LE(std::fabs(wrapped), pi * (1.0 + 1e-15));
      EXPECT_NEAR(std::remainder(wrapped - yaw, 2.0 * pi), 0.0, 1e-15 * (10.0 + limit));
      if (limit == 1.0) {
        EXPECT_EQ(wrapped, yaw);
      }
    }
  }
}

pose_2d any_pose(std::mt19937& source) {
  std::uniform_real_distribution<double> metres(-50.0, 50.0);
  std::uniform_real_distribution<double> radians(-pi, pi);
  return {metres(source), metres(source), radians(source)};
}

TEST(Pose, ProductIsThatOfMatrices_InverseGivesTheOrigin) {
  std::mt19937 source(9);
  for (int i = 0; i < test::scaled(2000); ++i) {
    const pose_2d a = any_pose(source);
    const pose_2d b = any_pose(source);
    const pose_2d product{a.x_m + std::cos(a.yaw_rad) * b.x_m - std::sin(a.yaw_rad) * b.y_m,
                          a.y_m + std::sin(a.yaw_rad) * b.x_m + std::cos(a.yaw_rad) * b.y_m,
                          a.yaw_rad + b.yaw_rad};
    expect_near(a * b, product, 1e-12);
    EXPECT_LE(std::fabs((a * b).yaw_rad), pi * (1.0 + 1e-15));
    expect_near(a * inverse(a), {}, 1e-12);
    expect_near(inverse(a) * a, {}, 1e-12);
  }
}

/// Where a robot is after `seconds`, in small steps, each along the direction half way through it.
pose_2d in_steps(const twist_2d& twist, double seconds) {
  constexpr int steps = 20'000;
  const double step = seconds / steps;
  pose_2d at;
  for (int i = 0; i < steps; ++i) {
    const double direction = at.yaw_rad + twist.yaw_rad_per_s * step / 2.0;
    at.x_m +=
        (std::cos(direction) * twist.x_m_per_s - std::sin(direction) * twist.y_m_per_s) * step;
    at.y_m +=
        (std::sin(direction) * twist.x_m_per_s + std::cos(direction) * twist.y_m_per_s) * step;
    at.yaw_rad += twist.yaw_rad_per_s * step;
  }
  return at;
}

// The x axis stays; the y axis, and with it the sense of rotation, points to the other side.
TEST(Mounting, UpsideDown_LeftIsRight) {
  constexpr twist_2d of{1.0, 0.5, -0.25};
  static_assert(mounting{}.upright(of) == of);
  static_assert(mounting{.pose = {}, .upside_down = true}.upright(of) == twist_2d{1.0, -0.5, 0.25});
}

TEST(MovedBy, IsMotionInManySmallSteps) {
  // A step of 1/20000 of the way misses the arc by a part of about a^2 / 24 / 20000^2.
  for (const twist_2d& twist :
       {twist_2d{1.0, 0.0, 0.0}, twist_2d{1.0, 0.5, 1.0}, twist_2d{-2.0, 1.0, -10.0},
        twist_2d{0.3, 0.0, 0.019}, twist_2d{0.3, 0.1, 0.021}, twist_2d{0.0, 0.0, 3.0}}) {
    for (const double seconds : {1.0, 0.1, -0.7}) {
      expect_near(moved_by(twist, seconds), in_steps(twist, seconds), 1e-7);
    }
  }
  static_assert(moved_by({2.0, -1.0, 0.0}, 3.0) == pose_2d{6.0, -3.0, 0.0});
}

TEST(MovedBy, SeriesAndClosedFormAgreeWhereTheyMeet) {
  for (const double turn : {0.02, -0.02}) {
    const pose_2d series = moved_by({1.0, 0.5, std::nextafter(turn, 0.0)}, 1.0);
    const pose_2d closed = moved_by({1.0, 0.5, std::nextafter(turn, turn * 2.0)}, 1.0);
    expect_near(series, closed, 1e-13);
  }
}

TEST(TwistTo, IsTheInverseOfMovedBy) {
  std::mt19937 source(10);
  std::uniform_real_distribution<double> metres(-3.0, 3.0);
  std::uniform_real_distribution<double> radians(-3.0, 3.0);
  for (int i = 0; i < test::scaled(2000); ++i) {
    const twist_2d twist{metres(source), metres(source), radians(source)};
    const double seconds = i % 2 == 0 ? 0.9 : -0.07;
    const twist_2d back = twist_to(moved_by(twist, seconds), seconds);
    EXPECT_NEAR(back.x_m_per_s, twist.x_m_per_s, 1e-11);
    EXPECT_NEAR(back.y_m_per_s, twist.y_m_per_s, 1e-11);
    EXPECT_NEAR(back.yaw_rad_per_s, twist.yaw_rad_per_s, 1e-11);
  }
}

TEST(SeenFrom, MovesTheMountedFrameWithTheRobot) {
  std::mt19937 source(11);
  std::uniform_real_distribution<double> metres(-3.0, 3.0);
  for (int i = 0; i < test::scaled(500); ++i) {
    const twist_2d twist{metres(source), metres(source), metres(source)};
    const pose_2d mount{metres(source), metres(source), metres(source)};
    expect_near(mount * moved_by(seen_from(mount, twist), 0.8), moved_by(twist, 0.8) * mount,
                1e-12);
  }
  // A lidar 1 m to the left of a robot that turns left goes backwards, and it looks to the left itself.
  const twist_2d own = seen_from({0.0, 1.0, pi / 2.0}, {0.0, 0.0, 2.0});
  EXPECT_NEAR(own.x_m_per_s, 0.0, 1e-15);
  EXPECT_NEAR(own.y_m_per_s, 2.0, 1e-15);
}

TEST(Interpolated, IsOnTheArcBetweenBothPoses) {
  // A quarter of a circle with a radius of 1 m around (0, 1).
  constexpr stamped_pose from{1'000, {0.0, 0.0, 0.0}};
  constexpr stamped_pose to{4'000, {1.0, 1.0, pi / 2.0}};
  expect_near(interpolated(from, to, 1'000), from.pose, 1e-15);
  expect_near(interpolated(from, to, 4'000), to.pose, 1e-15);
  expect_near(interpolated(from, to, 2'000), {0.5, 1.0 - std::cos(pi / 6.0), pi / 6.0}, 1e-15);
  expect_near(interpolated(from, to, 7'000), {0.0, 2.0, pi}, 1e-15);
  expect_near(interpolated(from, to, -2'000), {-1.0, 1.0, -pi / 2.0}, 1e-15);
  expect_near(interpolated(from, {1'000, to.pose}, 1'000), from.pose, 0.0);
  // Through the back, by the shorter way.
  expect_near(interpolated({0, {0, 0, 3.0}}, {10, {0, 0, -3.0}}, 5), {0, 0, pi}, 1e-15);
}

TEST(PieceAt, IsThePieceWithTheTime_WithAnyGuess) {
  constexpr std::array<stamped_pose, 6> path{
      {{10, {}}, {20, {}}, {20, {}}, {30, {}}, {31, {}}, {90, {}}}};
  for (std::size_t guess = 0; guess < 9; ++guess) {
    for (std::int64_t time = 0; time <= 100; ++time) {
      const auto piece = piece_at(path, time, guess);
      ASSERT_EQ(piece.has_value(), time >= 10 && time <= 90) << time;
      if (!piece) continue;
      ASSERT_LT(*piece + 1, path.size());
      EXPECT_LE(path[*piece].time_ns, time);
      EXPECT_GE(path[*piece + 1].time_ns, time);
    }
  }
  EXPECT_EQ(piece_at(path, 25), 2U);
  EXPECT_EQ(piece_at(path, 90), 4U);
  EXPECT_EQ(piece_at({}, 0), std::nullopt);
  EXPECT_EQ(piece_at(std::span(path).first(1), 10), std::nullopt);
}

TEST(PoseAt, IsInterpolated_AndUnknownOutside) {
  const std::vector<stamped_pose> path{{10, {1, 0, 0}}, {20, {2, 0, 0}}, {40, {2, 2, 0}}};
  expect_near(pose_at(path, 10).value(), {1, 0, 0}, 1e-15);
  expect_near(pose_at(path, 15).value(), {1.5, 0, 0}, 1e-15);
  expect_near(pose_at(path, 35).value(), {2, 1.5, 0}, 1e-15);
  expect_near(pose_at(path, 40).value(), {2, 2, 0}, 1e-15);
  EXPECT_EQ(pose_at(path, 9), std::nullopt);
  EXPECT_EQ(pose_at(path, 41), std::nullopt);
}

}  // namespace
}  // namespace g4lidar
