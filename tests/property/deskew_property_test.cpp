// SPDX-License-Identifier: MIT
// Deskewing with any points, times and paths: nothing is lost, nothing leaves its limits, and places stay where they are.
#include <gtest/gtest.h>
// GoogleTest first.
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "g4lidar/motion/deskew.hpp"
#include "support/check_cases.hpp"
#include "support/deskew_reference.hpp"

namespace g4lidar {
namespace {

/// Steps of time in ns, direction and range of points, each from a number.
using recipe = std::tuple<std::int32_t, std::uint16_t, std::uint16_t>;

std::vector<point> points_of(const std::vector<recipe>& recipes) {
  std::vector<point> points;
  std::int64_t time_ns = 1'000'000;
  for (const auto& [step, direction, range] : recipes) {
    time_ns = step % 13 == 0 ? 0 : time_ns + step % 3'000'000;  // also backwards
    point p;
    p.angle_deg = static_cast<float>(direction) * (360.0F / 65'536.0F);
    p.range_mm = range % 16 == 0 ? 0.0F : static_cast<float>(range) / 4.0F;
    p.time_ns = time_ns;
    p.flags = range % 16 == 0 ? point_flags::no_return : point_flags::none;
    points.push_back(p);
  }
  return points;
}

double part(std::int16_t number) { return static_cast<double>(number) / 32'768.0; }

std::vector<stamped_pose> path_of(
    const std::vector<std::tuple<std::uint32_t, std::int16_t, std::int16_t>>& recipes) {
  std::vector<stamped_pose> path;
  std::int64_t time_ns = -20'000'000;
  for (const auto& [step, metres, turn] : recipes) {
    time_ns += step % 20'000'000;
    path.push_back({time_ns, {40.0 * part(metres), 40.0 * part(turn), 3.0 * part(turn)}});
  }
  return path;
}

TEST(DeskewProperty, AnyPath_LeavesWhatIsOutside_AndKeepsPlacesInTheWorld) {
  test::check_cases(600, [] {
    const auto points = points_of(*rc::gen::scale(4.0, rc::gen::arbitrary<std::vector<recipe>>()));
    const auto path = path_of(
        *rc::gen::arbitrary<std::vector<std::tuple<std::uint32_t, std::int16_t, std::int16_t>>>());
    const auto [x, y, yaw] =
        *rc::gen::arbitrary<std::tuple<std::int16_t, std::int16_t, std::int16_t>>();
    const mounting mount{{part(x), part(y), 3.0 * part(yaw)}, x % 2 == 0};
    const std::uint16_t turn_deg = y % 2 == 0 ? 0 : 180;
    const std::int64_t reference_ns = *rc::gen::inRange<std::int64_t>(-10'000'000, 10'000'000);

    std::vector<point> out(points.size());
    const deskewed got = deskew(points, path, reference_ns, out, mount, turn_deg);
    RC_ASSERT(got.points.size() == points.size());
    const auto reference = pose_at(path, reference_ns);
    std::size_t outside = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const point& p = points[i];
      RC_ASSERT(out[i].angle_deg >= 0.0F && out[i].angle_deg < 360.0F);
      RC_ASSERT(out[i].time_ns == p.time_ns);
      const auto then = p.time_ns == 0 ? std::nullopt : pose_at(path, p.time_ns);
      RC_ASSERT(out[i].is_not_deskewed() == !(reference && then));
      if (out[i].is_not_deskewed()) {
        ++outside;
        RC_ASSERT(without(out[i].flags, point_flags::not_deskewed) == p.flags);
        RC_ASSERT(out[i].angle_deg == p.angle_deg && out[i].range_mm == p.range_mm);
        continue;
      }
      if (p.is_no_return()) {
        RC_ASSERT(out[i].range_mm == 0.0F);
        continue;
      }
      // The same place in the world.
      const auto in_world = [&](const point& measured, const pose_2d& robot) {
        return test::out_of(
            robot, test::on_robot(static_cast<double>(measured.angle_deg),
                                  static_cast<double>(measured.range_mm), mount, turn_deg));
      };
      const test::place_mm before = in_world(p, *then);
      const test::place_mm after = in_world(out[i], *reference);
      const double way = test::way_mm(*then, *reference, mount);
      RC_ASSERT(std::hypot(before.x - after.x, before.y - after.y) <=
                0.01 + 3e-6 * (static_cast<double>(p.range_mm) + way));
    }
    RC_ASSERT(outside == got.outside);
    RC_CLASSIFY(got.outside < points.size());
  });
}

}  // namespace
}  // namespace g4lidar
