// SPDX-License-Identifier: MIT
// Deskewing: worked examples, flags, what is outside of the motion, and grids of the result.
#include "g4lidar/motion/deskew.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "g4lidar/grid.hpp"
#include "support/deskew_reference.hpp"
#include "support/moving_lidar.hpp"
#include "support/test_scale.hpp"

namespace g4lidar {
namespace {

using test::any_mounting;
using test::at;
using test::begin_ns;
using test::driven;
using test::some_points;

constexpr double pi = std::numbers::pi;
constexpr std::int64_t second_ns = 1'000'000'000;

// A robot drives forward at 1 m/s with a wall 2 m ahead: seen 0.1 s later, the wall is 100 mm nearer.
TEST(Deskew, WorkedExamples) {
  constexpr twist_2d forward{1.0, 0.0, 0.0};
  constexpr std::int64_t later_ns = begin_ns + second_ns / 10;
  const auto seen = [&](const point& p, const twist_2d& twist, const mounting& mount = {}) {
    std::array<point, 1> one{p};
    EXPECT_EQ(deskew(one, twist, later_ns, mount).outside, 0U);
    return one[0];
  };
  EXPECT_NEAR(seen(at(180, 2000, begin_ns), forward).range_mm, 1900.0F, 0.01F);
  EXPECT_NEAR(seen(at(0, 2000, begin_ns), forward).range_mm, 2100.0F, 0.01F);
  EXPECT_NEAR(seen(at(0, 2000, begin_ns), forward).angle_deg, 0.0F, 1e-4F);
  // Past the wall: the direction turns round.
  EXPECT_NEAR(seen(at(180, 60, begin_ns), forward).range_mm, 40.0F, 0.01F);
  EXPECT_NEAR(seen(at(180, 60, begin_ns), forward).angle_deg, 0.0F, 1e-4F);
  EXPECT_TRUE(seen(at(180, 60, begin_ns), forward).is_too_near());
  EXPECT_FALSE(seen(at(180, 160, begin_ns), forward).is_too_near())
      << "the flag of the measurement";
  // 100 mm to the left, at 90 degrees clockwise from the cable, and then 100 mm behind, too.
  EXPECT_NEAR(seen(at(90, 100, begin_ns), forward).angle_deg, 45.0F, 1e-4F);
  EXPECT_NEAR(seen(at(90, 100, begin_ns), forward).range_mm, 141.42136F, 0.01F);
  // A robot that turns to the left by 0.1 radians finds the same thing farther to the right: clockwise.
  const point turned = seen(at(180, 2000, begin_ns), {0.0, 0.0, 1.0});
  EXPECT_NEAR(turned.angle_deg, 180.0F + 5.7295780F, 1e-4F);
  EXPECT_NEAR(turned.range_mm, 2000.0F, 0.01F);
  EXPECT_NEAR(seen(at(180, 2000, begin_ns), {0.0, 0.0, 1.0}, {{}, true}).angle_deg,
              180.0F - 5.7295780F, 1e-4F);
  // Looking back from the back of the robot.
  EXPECT_NEAR(seen(at(180, 2000, begin_ns), forward, {{-0.3, 0.0, pi}, false}).range_mm, 2100.0F,
              0.01F);
  // Without return only the direction turns.
  const point none = seen(at(359.0F, 0, begin_ns), {5.0, 1.0, 1.0});
  EXPECT_NEAR(none.angle_deg, 4.7295780F, 1e-4F);
  EXPECT_EQ(none.range_mm, 0.0F);
  EXPECT_TRUE(none.is_no_return());
}

TEST(Deskew, NoMotion_LeavesPointsWithinRounding) {
  std::mt19937 source(24);
  std::vector<point> points = some_points(source, 1000, 0.0);
  const std::vector<point> before = points;
  EXPECT_EQ(deskew(points, twist_2d{}, 0, any_mounting(source)).outside, 0U);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_NEAR(points[i].angle_deg, before[i].angle_deg, 3.1e-5F);
    ASSERT_NEAR(points[i].range_mm, before[i].range_mm, 0.001F + 2e-7F * before[i].range_mm);
  }
}

TEST(Deskew, UnknownTimes_AreLeftAndCounted) {
  std::mt19937 source(25);
  std::vector<point> points = some_points(source, 300, 0.0);
  for (const std::size_t i : {0U, 63U, 64U, 130U, 131U, 299U}) points[i].time_ns = 0;
  std::vector<point> out(points.size());
  const deskewed got = deskew(points, twist_2d{1.0, 0.0, 1.0}, begin_ns, out);
  EXPECT_EQ(got.outside, 6U);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(out[i].is_not_deskewed(), points[i].time_ns == 0) << i;
    if (points[i].time_ns != 0) continue;
    point expected = points[i];
    expected.flags = expected.flags | point_flags::not_deskewed;
    ASSERT_EQ(out[i], expected);
  }
  // Also where the times of the others are negative: 0 is no time.
  std::array<point, 3> early{at(10, 500, -100), at(10, 500, 0), at(10, 500, 100)};
  EXPECT_EQ(deskew(early, twist_2d{1.0, 0.0, 0.0}, 0).outside, 1U);
  EXPECT_TRUE(early[1].is_not_deskewed());
}

TEST(Deskew, OutsideOfThePath_IsLeftAndCounted) {
  const std::vector<stamped_pose> path{{begin_ns, {}}, {begin_ns + 100, {1, 0, 0}}};
  std::array<point, 4> points{at(180, 5000, begin_ns - 1), at(180, 5000, begin_ns),
                              at(180, 5000, begin_ns + 100), at(180, 5000, begin_ns + 101)};
  const std::array<point, 4> before = points;
  EXPECT_EQ(deskew(points, path, begin_ns).outside, 2U);
  EXPECT_TRUE(points[0].is_not_deskewed());
  EXPECT_EQ(points[0].range_mm, 5000.0F);
  EXPECT_NEAR(points[1].range_mm, 5000.0F, 0.01F);
  EXPECT_NEAR(points[2].range_mm, 6000.0F, 0.02F);
  EXPECT_TRUE(points[3].is_not_deskewed());
  // With a longer path the rest can follow: what was left is as it was measured.
  std::array<point, 2> rest{points[0], points[3]};
  const std::vector<stamped_pose> longer{{begin_ns - 100, {-1, 0, 0}}, {begin_ns + 200, {2, 0, 0}}};
  EXPECT_EQ(deskew(rest, longer, begin_ns).outside, 0U);
  EXPECT_FALSE(rest[0].is_not_deskewed());
  EXPECT_NEAR(rest[1].range_mm, 6010.0F, 0.02F);
  // Without a pose for the reference time nothing is moved.
  for (const std::int64_t reference_ns : {begin_ns - 1, begin_ns + 101}) {
    std::array<point, 4> same = before;
    EXPECT_EQ(deskew(same, path, reference_ns).outside, 4U);
    for (std::size_t i = 0; i < same.size(); ++i) {
      EXPECT_TRUE(same[i].is_not_deskewed());
      EXPECT_EQ(same[i].range_mm, before[i].range_mm);
      EXPECT_EQ(same[i].angle_deg, before[i].angle_deg);
    }
  }
  EXPECT_EQ(deskew(points, std::span<const stamped_pose>(), begin_ns).outside, 4U);
}

TEST(Deskew, FunctionWithoutAPose_LeavesThePoint) {
  std::array<point, 4> points{at(180, 5000, 10), at(180, 5000, 20), at(180, 5000, 30),
                              at(180, 5000, 0)};
  const auto motion = [](std::int64_t time_ns) -> std::optional<pose_2d> {
    if (time_ns == 20) return std::nullopt;
    return pose_2d{static_cast<double>(time_ns) * 0.01, 0.0, 0.0};
  };
  EXPECT_EQ(deskew(points, motion, 10).outside, 2U);
  EXPECT_TRUE(points[1].is_not_deskewed() && points[3].is_not_deskewed());
  EXPECT_NEAR(points[2].range_mm, 5200.0F, 0.02F);
  EXPECT_EQ(deskew(points, motion, 20).outside, 4U);
}

TEST(Deskew, PathWithTwoPosesAtOneTime_JumpsThere) {
  const std::vector<stamped_pose> path{
      {10, {0, 0, 0}}, {20, {0, 0, 0}}, {20, {1, 0, 0}}, {30, {1, 0, 0}}};
  std::array<point, 3> points{at(180, 5000, 15), at(180, 5000, 20), at(180, 5000, 25)};
  EXPECT_EQ(deskew(points, path, 10).outside, 0U);
  EXPECT_NEAR(points[0].range_mm, 5000.0F, 0.01F);
  EXPECT_NEAR(points[2].range_mm, 6000.0F, 0.01F);
  // At the first time there are two poses: the first one counts.
  std::array<point, 1> first{at(180, 5000, 20)};
  EXPECT_EQ(deskew(first, std::span(path).subspan(1), 30).outside, 0U);
  EXPECT_NEAR(first[0].range_mm, 4000.0F, 0.01F);
}

TEST(Deskew, WithoutMotion_EveryBitStays) {
  std::mt19937 source(27);
  const std::vector<point> before = some_points(source, 2000, 0.0);
  std::vector<point> points = before;
  EXPECT_EQ(deskew(points, std::span<const stamped_pose>(), begin_ns).outside, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    point expected = before[i];
    expected.flags = expected.flags | point_flags::not_deskewed;
    ASSERT_EQ(points[i], expected);
  }
}

TEST(Deskew, InPlace_EqualsOtherMemory) {
  std::mt19937 source(26);
  const std::vector<point> points = some_points(source, 777, 0.05);
  std::vector<point> out(points.size() + 3);
  std::vector<point> same = points;
  const twist_2d twist{0.5, 0.1, -2.0};
  EXPECT_EQ(deskew(points, twist, begin_ns, out).points.size(), points.size());
  EXPECT_EQ(deskew(same, twist, begin_ns).points.data(), same.data());
  EXPECT_TRUE(std::equal(same.begin(), same.end(), out.begin()));
  EXPECT_EQ(deskew(std::span<point>(), twist, begin_ns).points.size(), 0U);
}

TEST(Deskew, CompilesToAConstant) {
  constexpr float range_mm = [] {
    std::array<point, 1> one{};
    one[0].angle_deg = 180.0F;
    one[0].range_mm = 2000.0F;
    one[0].time_ns = 1;
    (void)deskew(one, twist_2d{1.0, 0.0, 0.0}, 100'000'001);
    return one[0].range_mm;
  }();
  static_assert(range_mm > 1899.99F && range_mm < 1900.01F);
}

double seconds_of(std::int64_t time_ns) { return static_cast<double>(time_ns - begin_ns) * 1e-9; }

/// A square room of 4 by 4 m around the origin: the range in a direction, in millimetres.
double room_mm(const pose_2d& lidar, double bearing_rad) {
  const double c = std::cos(lidar.yaw_rad + bearing_rad);
  const double s = std::sin(lidar.yaw_rad + bearing_rad);
  const double to_x = c == 0.0 ? 1e9 : ((c > 0.0 ? 2.0 : -2.0) - lidar.x_m) / c;
  const double to_y = s == 0.0 ? 1e9 : ((s > 0.0 ? 2.0 : -2.0) - lidar.y_m) / s;
  return 1000.0 * std::min(to_x, to_y);
}

// A lidar on a robot that drives and turns in a room: the grid after deskewing shows the room from one place.
TEST(Deskew, GridOfTheResult_IsTheRoomFromTheReference) {
  const twist_2d twist{1.0, 0.0, pi / 2.0};
  const std::int64_t reference_ns = begin_ns + second_ns / 7;
  std::vector<point> points;
  for (int i = 0; i < 2600; ++i) {  // two turns, so that every bin has a point
    const std::int64_t time_ns = begin_ns + i * 111'111;
    const double angle = std::fmod(i * 0.28, 360.0);
    const pose_2d robot = driven({}, twist, seconds_of(time_ns));
    points.push_back(at(static_cast<float>(angle),
                        static_cast<float>(room_mm(robot, (180.0 - angle) * pi / 180.0)), time_ns));
  }
  EXPECT_EQ(deskew(points, twist, reference_ns).outside, 0U);
  std::array<float, 360> ranges_m{};
  fill_grid(points, ranges_m, {.to = frame::robot, .pick = grid_pick::minimum});
  const pose_2d reference = driven({}, twist, seconds_of(reference_ns));
  for (std::size_t bin = 0; bin < ranges_m.size(); ++bin) {
    const double bearing = (static_cast<double>(bin) - 180.0) * pi / 180.0;
    double least = 1e9;
    double greatest = 0.0;
    for (double off = -0.51; off < 0.52; off += 0.02) {
      const double range_m = room_mm(reference, bearing + off * pi / 180.0) / 1000.0;
      least = std::min(least, range_m);
      greatest = std::max(greatest, range_m);
    }
    EXPECT_GE(static_cast<double>(ranges_m[bin]), least - 0.001) << bin;
    EXPECT_LE(static_cast<double>(ranges_m[bin]), greatest + 0.001) << bin;
  }
}

// Two things in one direction after deskewing: the nearer one wins.
TEST(Deskew, GridOfTheResult_HoldsTheNearestReturn) {
  const twist_2d turning{0.0, 0.0, 1.0};
  // Measured 0.1 s apart, 5.73 degrees of the robot's turn apart, so both are straight ahead of the reference.
  std::array<point, 2> points{at(180.0F, 2000, begin_ns),
                              at(180.0F - 5.7295780F, 900, begin_ns - second_ns / 10)};
  EXPECT_EQ(deskew(points, turning, begin_ns).outside, 0U);
  std::array<float, 360> ranges_m{};
  for (const bool swapped : {false, true}) {
    if (swapped) std::swap(points[0], points[1]);
    fill_grid(points, ranges_m, {.to = frame::robot, .pick = grid_pick::minimum});
    EXPECT_NEAR(ranges_m[180], 0.9F, 1e-4F);
  }
}

}  // namespace
}  // namespace g4lidar
