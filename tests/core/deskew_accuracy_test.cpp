// SPDX-License-Identifier: MIT
// Deskewing against a reference in double precision: twists, paths, functions and mountings.
#include "g4lidar/motion/deskew.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "support/deskew_reference.hpp"
#include "support/moving_lidar.hpp"
#include "support/test_scale.hpp"

namespace g4lidar {
namespace {

using test::any_mounting;
using test::at;
using test::begin_ns;
using test::driven;
using test::seen_again;
using test::some_points;

constexpr double pi = std::numbers::pi;

/// `got` is `p` seen again, within the documented bounds.
void expect_seen(const point& got, const point& p, const pose_2d& then, const pose_2d& reference,
                 const mounting& mount, std::uint16_t turn_deg) {
  const test::direction_and_range expected = seen_again(p, then, reference, mount, turn_deg);
  const auto angle_deg = static_cast<double>(got.angle_deg);
  const auto range_mm = static_cast<double>(got.range_mm);
  ASSERT_GE(got.angle_deg, 0.0F);
  ASSERT_LT(got.angle_deg, 360.0F);
  ASSERT_EQ(got.time_ns, p.time_ns);
  ASSERT_EQ(got.revolution, p.revolution);
  ASSERT_EQ(got.flags, p.flags);
  const double off_deg = std::fabs(std::remainder(angle_deg - expected.angle_deg, 360.0));
  if (p.is_no_return()) {
    ASSERT_EQ(got.range_mm, 0.0F);
    ASSERT_LE(off_deg, 1e-4);
    return;
  }
  const double way_mm = test::way_mm(then, reference, mount);
  const auto measured_mm = static_cast<double>(p.range_mm);
  if (way_mm < 0.5 * measured_mm) {
    ASSERT_LE(off_deg, 1e-4) << p.angle_deg << " degrees, " << p.range_mm << " mm, way " << way_mm;
    ASSERT_LE(std::fabs(range_mm - expected.range_mm), 0.01 + 1e-6 * measured_mm);
  } else {
    const double aside_mm = off_deg * (pi / 180.0) * expected.range_mm;
    ASSERT_LE(std::hypot(range_mm - expected.range_mm, aside_mm),
              0.01 + 3e-6 * (measured_mm + way_mm));
  }
}

double seconds_of(std::int64_t time_ns) { return static_cast<double>(time_ns - begin_ns) * 1e-9; }

TEST(Deskew, Twist_AgreesWithTheReference) {
  std::mt19937 source(21);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int i = 0; i < test::scaled(60); ++i) {
    const double fast = i % 3 == 0 ? 10.0 : 1.0;
    const twist_2d twist{fast * any(source), fast * any(source),
                         i % 5 == 0 ? 0.0 : fast * any(source)};
    const mounting mount = i % 4 == 0 ? mounting{} : any_mounting(source);
    const std::uint16_t turn_deg = source() % 2 == 0 ? 0 : 180;
    const std::vector<point> points = some_points(source, 700, i % 2 == 0 ? 0.0 : 0.02);
    // Before, within and after the points.
    const std::int64_t reference_ns = begin_ns + static_cast<std::int64_t>(any(source) * 2e8);
    std::vector<point> out(points.size());
    const deskewed got = deskew(points, twist, reference_ns, out, mount, turn_deg);
    ASSERT_EQ(got.outside, 0U);
    ASSERT_EQ(got.points.data(), out.data());
    ASSERT_EQ(got.points.size(), points.size());
    const pose_2d origin;
    const pose_2d reference = driven(origin, twist, seconds_of(reference_ns));
    for (std::size_t k = 0; k < points.size(); ++k) {
      expect_seen(out[k], points[k], driven(origin, twist, seconds_of(points[k].time_ns)),
                  reference, mount, turn_deg);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

/// Poses every `step_ns` along a walk of changing twists, far from the origin.
std::vector<stamped_pose> any_path(std::mt19937& source, std::int64_t step_ns, std::size_t count) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  std::vector<stamped_pose> path;
  pose_2d now{300.0 * any(source), 300.0 * any(source), 3.0 * any(source)};
  std::int64_t time_ns = begin_ns;
  while (path.size() < count) {
    path.push_back({time_ns, now});
    now = driven(now, {3.0 * any(source), any(source), 6.0 * any(source)},
                 static_cast<double>(step_ns) * 1e-9);
    time_ns += step_ns;
  }
  return path;
}

/// The pose on the arc between two poses of a path, with libm.
pose_2d on_path(const std::vector<stamped_pose>& path, std::int64_t time_ns) {
  std::size_t i = 0;
  while (i + 2 < path.size() && path[i + 1].time_ns <= time_ns) ++i;
  const pose_2d& a = path[i].pose;
  const pose_2d& b = path[i + 1].pose;
  const double turn = std::remainder(b.yaw_rad - a.yaw_rad, 2.0 * pi);
  const double part = static_cast<double>(time_ns - path[i].time_ns) /
                      static_cast<double>(path[i + 1].time_ns - path[i].time_ns);
  // The chord of the part has the direction of the whole chord, turned back by half of the turn that is left.
  const double whole = std::hypot(b.x_m - a.x_m, b.y_m - a.y_m);
  const double half = turn / 2.0;
  const double length =
      std::fabs(half) < 1e-9 ? whole * part : whole * std::sin(half * part) / std::sin(half);
  const double direction = std::atan2(b.y_m - a.y_m, b.x_m - a.x_m) - half * (1.0 - part);
  return {a.x_m + length * std::cos(direction), a.y_m + length * std::sin(direction),
          a.yaw_rad + turn * part};
}

TEST(Deskew, PathAndFunction_AgreeWithTheReference) {
  std::mt19937 source(22);
  for (int i = 0; i < test::scaled(24); ++i) {
    const std::int64_t step_ns = i % 3 == 0 ? 1'000'000 : i % 3 == 1 ? 20'000'000 : 90'000'000;
    const std::vector<stamped_pose> path =
        any_path(source, step_ns, static_cast<std::size_t>(110'000'000 / step_ns) + 2);
    const mounting mount = i % 4 == 0 ? mounting{} : any_mounting(source);
    const std::uint16_t turn_deg = source() % 2 == 0 ? 0 : 180;
    const std::vector<point> points = some_points(source, 900, 0.0);  // 100 ms
    const std::int64_t reference_ns = begin_ns + static_cast<std::int64_t>(source() % 110'000'000U);
    std::vector<point> out(points.size());
    ASSERT_EQ(deskew(points, path, reference_ns, out, mount, turn_deg).outside, 0U);
    std::vector<point> by_function(points.size());
    const auto motion = [&](std::int64_t time_ns) { return on_path(path, time_ns); };
    ASSERT_EQ(deskew(points, motion, reference_ns, by_function, mount, turn_deg).outside, 0U);
    const pose_2d reference = on_path(path, reference_ns);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const pose_2d then = on_path(path, points[k].time_ns);
      expect_seen(out[k], points[k], then, reference, mount, turn_deg);
      expect_seen(by_function[k], points[k], then, reference, mount, turn_deg);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

TEST(Deskew, PathOfConstantVelocity_EqualsTheTwist) {
  std::mt19937 source(23);
  const twist_2d twist{1.5, -0.2, 1.2};
  std::vector<stamped_pose> path;
  for (int i = 0; i <= 20; ++i)
    path.push_back({begin_ns + i * 10'000'000, driven({4, 5, 2}, twist, 0.01 * i)});
  const std::vector<point> points = some_points(source, 1280, 0.0);
  std::vector<point> a(points.size());
  std::vector<point> b(points.size());
  const mounting mount = any_mounting(source);
  EXPECT_EQ(deskew(points, twist, begin_ns + 50'000'000, a, mount).outside, 0U);
  EXPECT_EQ(deskew(points, path, begin_ns + 50'000'000, b, mount).outside, 0U);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_NEAR(std::remainder(a[i].angle_deg - b[i].angle_deg, 360.0F), 0.0F, 1e-4F);
    ASSERT_NEAR(a[i].range_mm, b[i].range_mm, 0.01F);
  }
}

}  // namespace
}  // namespace g4lidar
