// SPDX-License-Identifier: MIT
// Two lidars on a robot as one: a known room, lidars that are upside down, of different frequency, or lost.
#include "g4lidar/merge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "g4lidar/cartesian.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/sim/scanner.hpp"
#include "g4lidar/sim/world.hpp"
#include "support/deskew_reference.hpp"
#include "support/scan_cutter.hpp"

namespace g4lidar {
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::int64_t begin_ns = 5'000'000'000'000;

/// In a room of 6 by 4 m around the origin: the range in a direction, in millimetres.
double room_mm(double x_m, double y_m, double bearing_rad) {
  const double c = std::cos(bearing_rad);
  const double s = std::sin(bearing_rad);
  const double to_x = c == 0.0 ? 1e9 : ((c > 0.0 ? 3.0 : -3.0) - x_m) / c;
  const double to_y = s == 0.0 ? 1e9 : ((s > 0.0 ? 2.0 : -2.0) - y_m) / s;
  return 1000.0 * std::min(to_x, to_y);
}

/// A revolution of a lidar on a robot that drives with `twist` from the middle of the room at `begin_ns`; it ends at
/// `end_ns`. Nothing comes back from directions within `silent_deg` of the cable.
std::vector<point> revolution(const twist_2d& twist, const mounting& mount, std::int64_t end_ns,
                              double frequency_hz, double silent_deg = 0.0,
                              double turn_deg = 180.0) {
  const auto count = static_cast<std::int64_t>(9000.0 / frequency_hz);
  std::vector<point> points;
  for (std::int64_t i = 0; i < count; ++i) {
    point p;
    p.time_ns = end_ns - (count - 1 - i) * 111'111;
    p.angle_deg = static_cast<float>(static_cast<double>(i) * 360.0 / static_cast<double>(count));
    const pose_2d robot = test::driven({}, twist, static_cast<double>(p.time_ns - begin_ns) * 1e-9);
    const test::place_mm origin = test::out_of(robot, test::on_robot(0.0, 0.0, mount));
    const test::place_mm ahead =
        test::out_of(robot, test::on_robot(static_cast<double>(p.angle_deg), 1.0, mount, turn_deg));
    const double bearing = std::atan2(ahead.y - origin.y, ahead.x - origin.x);
    const bool silent = static_cast<double>(p.angle_deg) < silent_deg ||
                        static_cast<double>(p.angle_deg) > 360.0 - silent_deg;
    p.range_mm =
        silent ? 0.0F : static_cast<float>(room_mm(origin.x / 1000.0, origin.y / 1000.0, bearing));
    if (silent) p.flags = point_flags::no_return;
    points.push_back(p);
  }
  return points;
}

const mounting front{{0.4, 0.1, 0.5}, false};
const mounting rear{{-0.4, -0.1, 3.0}, true};
constexpr twist_2d driving{0.8, 0.1, 1.2};

/// Each return is on a wall of the room, seen from the robot at `reference_ns`.
void expect_on_walls(std::span<const point> points, const twist_2d& twist,
                     std::int64_t reference_ns) {
  const pose_2d robot =
      test::driven({}, twist, static_cast<double>(reference_ns - begin_ns) * 1e-9);
  for (const point& p : points) {
    const xy_point at = to_xy(p, frame::robot);
    const test::place_mm world = test::out_of(
        robot, {static_cast<double>(at.x_m) * 1000.0, static_cast<double>(at.y_m) * 1000.0});
    const double off = std::max(std::fabs(world.x) - 3000.0, std::fabs(world.y) - 2000.0);
    ASSERT_NEAR(off, 0.0, 0.1);
  }
}

TEST(Merge, TwoLidarsOnAMovingRobot_SeeOneRoom) {
  const std::vector<point> a = revolution(driving, front, begin_ns + 200'000'000, 7.0);
  const std::vector<point> b =
      revolution(driving, rear, begin_ns + 230'000'000, 11.0);  // faster, later
  const std::int64_t reference_ns = begin_ns + 210'000'000;
  const std::array<mounted_scan, 2> lidars{{{a, front}, {b, rear}}};
  std::vector<point> out(a.size() + b.size());
  const merged got = merge_scans(lidars, driving, reference_ns, out);
  EXPECT_EQ(got.lost, 0U);
  EXPECT_EQ(got.outside, 0U);
  ASSERT_EQ(got.points.size(), out.size());
  expect_on_walls(got.points, driving, reference_ns);
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(got.points[i].time_ns, a[i].time_ns);
  for (std::size_t i = 0; i < b.size(); ++i)
    ASSERT_EQ(got.points[a.size() + i].time_ns, b[i].time_ns);

  // The same by a path and by a function.
  std::vector<stamped_pose> path;
  for (int i = 0; i <= 50; ++i) {
    path.push_back({begin_ns + i * 5'000'000, test::driven({}, driving, 0.005 * i)});
  }
  EXPECT_EQ(merge_scans(lidars, path, reference_ns, out).outside, 0U);
  expect_on_walls(out, driving, reference_ns);
  const auto motion = [&](std::int64_t time_ns) { return pose_at(path, time_ns); };
  EXPECT_EQ(merge_scans(lidars, motion, reference_ns, out).outside, 0U);
  expect_on_walls(out, driving, reference_ns);
}

TEST(Merge, LidarsOfDifferentTurns_SeeOneRoom) {
  for (const bool upside_down : {false, true}) {
    const mounting place{{0.4, 0.1, 0.5}, upside_down};
    const std::vector<point> a =
        revolution(driving, place, begin_ns + 200'000'000, 7.0, 0.0, 0.0);  // not turned
    const std::vector<point> b = revolution(driving, rear, begin_ns + 230'000'000, 11.0);
    const std::int64_t reference_ns = begin_ns + 210'000'000;
    const std::array<mounted_scan, 2> lidars{{{a, place, 0}, {b, rear}}};
    std::vector<point> out(a.size() + b.size());
    const merged got = merge_scans(lidars, driving, reference_ns, out);
    EXPECT_EQ(got.lost, 0U);
    EXPECT_EQ(got.outside, 0U);
    expect_on_walls(got.points, driving, reference_ns);
    const point& first = got.points.front();
    EXPECT_EQ(first.time_ns, a.front().time_ns);
  }
}

TEST(Merge, GridAroundTheRobot_HoldsTheRoom) {
  const std::vector<point> a = revolution({}, front, begin_ns, 5.0);
  const std::vector<point> b = revolution({}, rear, begin_ns, 7.0);
  const std::array<mounted_scan, 2> lidars{{{a, front}, {b, rear}}};
  std::vector<point> out(a.size() + b.size());
  std::array<float, 360> ranges_m{};
  fill_grid(merge_scans(lidars, twist_2d{}, begin_ns, out).points, ranges_m,
            {.pick = grid_pick::minimum});
  for (std::size_t bin = 0; bin < ranges_m.size(); ++bin) {
    double least = 1e9;
    double greatest = 0.0;
    for (double off = -0.51; off < 0.52; off += 0.02) {
      const double range_m =
          room_mm(0.0, 0.0, (static_cast<double>(bin) - 180.0 + off) * pi / 180.0) / 1000.0;
      least = std::min(least, range_m);
      greatest = std::max(greatest, range_m);
    }
    EXPECT_GE(static_cast<double>(ranges_m[bin]), least - 0.001) << bin;
    EXPECT_LE(static_cast<double>(ranges_m[bin]), greatest + 0.001) << bin;
  }
}

TEST(Merge, NothingCameBack_IsADirectionOfTheRobot) {
  // Nothing within 20 degrees of the cables: behind the front lidar's own back, and so on.
  const std::vector<point> a = revolution({}, {{0.3, 0.0, pi / 2.0}, false}, begin_ns, 7.0, 20.0);
  const std::array<mounted_scan, 1> lidars{{{a, {{0.3, 0.0, pi / 2.0}, false}}}};
  std::vector<point> out(a.size());
  std::array<float, 360> ranges_m{};
  fill_grid(merge_scans(lidars, twist_2d{}, begin_ns, out).points, ranges_m,
            {.pick = grid_pick::minimum});
  // The lidar looks to the left, so its cable is to the right: -90 degrees.
  EXPECT_TRUE(std::isinf(ranges_m[90]));
  EXPECT_TRUE(std::isinf(ranges_m[80]));
  EXPECT_FALSE(std::isinf(ranges_m[60]));
  EXPECT_FALSE(std::isinf(ranges_m[270]));
}

TEST(Merge, LostLidar_IsMarked_AndTheRestGoesOn) {
  std::vector<point> out(4000);
  // Which lidars are lost whose scans ended so long before the reference time.
  const auto lost = [&](std::int64_t front_age_ns, std::int64_t rear_age_ns,
                        std::int64_t fresh_ns = fresh_scan_ns) {
    const std::vector<point> a = revolution({}, front, begin_ns - front_age_ns, 7.0);
    const std::vector<point> b = revolution({}, rear, begin_ns - rear_age_ns, 9.0);
    const std::array<mounted_scan, 2> lidars{{{a, front}, {b, rear}}};
    const merged got = merge_scans(lidars, twist_2d{}, begin_ns, out, fresh_ns);
    expect_on_walls(got.points, {}, begin_ns);
    EXPECT_EQ(got.points.size(),
              (got.is_lost(0) ? 0U : a.size()) + (got.is_lost(1) ? 0U : b.size()));
    return got.lost;
  };
  EXPECT_EQ(lost(0, 0), 0U);
  EXPECT_EQ(lost(0, 600'000'000), 2U);
  EXPECT_EQ(lost(600'000'000, 0), 1U);
  EXPECT_EQ(lost(600'000'000, 700'000'000), 3U);
  EXPECT_EQ(lost(0, fresh_scan_ns), 0U);
  EXPECT_EQ(lost(0, fresh_scan_ns + 1), 2U);
  EXPECT_EQ(lost(0, -fresh_scan_ns), 0U);
  EXPECT_EQ(lost(0, -fresh_scan_ns - 1), 2U);
  EXPECT_EQ(lost(100, 101, 100), 2U);
}

TEST(Merge, LidarWithoutScanOrTime_IsLost) {
  const std::vector<point> a = revolution({}, front, begin_ns, 7.0);
  std::vector<point> b = revolution({}, rear, begin_ns, 7.0);
  b.back().time_ns = 0;
  std::vector<point> out(a.size());
  const std::array<mounted_scan, 3> lidars{{{b, rear}, {a, front}, {{}, rear}}};
  EXPECT_EQ(merge_scans(lidars, twist_2d{}, begin_ns, out).lost, 5U);
  EXPECT_EQ(merge_scans(lidars, twist_2d{}, 0, out).lost, 7U);
  EXPECT_EQ(merge_scans({}, twist_2d{}, begin_ns, out).points.size(), 0U);
}

TEST(Merge, OutsideOfTheMotion_IsPlacedWithoutIt_AndCounted) {
  const std::vector<point> a = revolution({}, front, begin_ns, 7.0);
  std::vector<point> b = revolution({}, rear, begin_ns, 7.0);
  b[5].time_ns = 0;
  const std::array<mounted_scan, 2> lidars{{{a, front}, {b, rear}}};
  std::vector<point> out(a.size() + b.size());
  merged got = merge_scans(lidars, twist_2d{}, begin_ns, out);
  EXPECT_EQ(got.outside, 1U);
  EXPECT_TRUE(out[a.size() + 5].is_not_deskewed());
  expect_on_walls(got.points, {}, begin_ns);
  got = merge_scans(lidars, std::span<const stamped_pose>(), begin_ns, out);
  EXPECT_EQ(got.outside, out.size());
  expect_on_walls(got.points, {}, begin_ns);
}

/// The first whole revolution of a simulated lidar, whose samples are 111 us apart.
std::vector<point> simulated(const sim::world& world, const pose_2d& lidar,
                             std::uint16_t frequency_chz) {
  sim::world seen = world;
  seen.lidar = {lidar.x_m, lidar.y_m,
                lidar.yaw_rad * 180.0 / pi + 180.0};  // angle 0 is at the cable
  sim::scanner scanner(seen, {.scan_frequency_chz = frequency_chz});
  test::scan_cutter cutter(4000);
  for (std::int64_t time_ns = begin_ns; cutter.scans().size() < 2; time_ns += 40 * 111'111) {
    const auto packet = packet_view::from(scanner.next().data);
    if (packet) cutter.feed(*packet, time_ns, 111'111);
  }
  return cutter.scans()[1].points;
}

double distance_mm(const sim::wall& wall, test::place_mm at) {
  const double dx = wall.x2_m - wall.x1_m;
  const double dy = wall.y2_m - wall.y1_m;
  const double x = at.x / 1000.0 - wall.x1_m;
  const double y = at.y / 1000.0 - wall.y1_m;
  const double along = std::clamp((x * dx + y * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return 1000.0 * std::hypot(x - along * dx, y - along * dy);
}

TEST(Merge, TwoSimulatedLidars_SeeTheSameWalls) {
  const sim::world world = sim::built_in_world();
  const pose_2d robot{world.lidar.x_m, world.lidar.y_m, 0.7};
  const mounting left{{0.05, 0.15, 1.0}, false};
  const mounting right{{-0.1, -0.15, -1.2}, false};
  const std::vector<point> a = simulated(world, robot * left.pose, 700);
  const std::vector<point> b = simulated(world, robot * right.pose, 1100);
  ASSERT_NEAR(static_cast<double>(a.size()), 1286.0, 3.0);
  ASSERT_NEAR(static_cast<double>(b.size()), 818.0, 3.0);
  const std::array<mounted_scan, 2> lidars{{{a, left}, {b, right}}};
  std::vector<point> out(a.size() + b.size());
  const merged got = merge_scans(lidars, twist_2d{}, a.back().time_ns, out);
  ASSERT_EQ(got.points.size(), out.size());
  ASSERT_EQ(got.outside, 0U);
  for (const point& p : got.points) {
    if (p.is_no_return()) continue;
    const xy_point at = to_xy(p, frame::robot);
    const test::place_mm place = test::out_of(
        robot, {static_cast<double>(at.x_m) * 1000.0, static_cast<double>(at.y_m) * 1000.0});
    double nearest = 1e9;
    for (const sim::wall& wall : world.walls) nearest = std::min(nearest, distance_mm(wall, place));
    // Half of 1/64 degree at 16 m, and half of a quarter of a millimetre.
    ASSERT_LE(nearest, 2.5);
  }
}

}  // namespace
}  // namespace g4lidar
