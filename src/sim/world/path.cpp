// SPDX-License-Identifier: MIT
// Cubic pieces between the points of a path. The speeds at the points are those of Fritsch and
// Butland (SIAM J. Sci. Stat. Comput. 5, 1984): a weighted harmonic mean of the mean speeds on both
// sides, so that no coordinate passes the values between which it is.
#include "sim/exact.hpp"

#include "g4lidar/sim/world.hpp"

#include <algorithm>
#include <array>
#include <cassert>

#include "g4lidar/detail/saturating.hpp"
#include "sim/arithmetic.hpp"

namespace g4lidar::sim {
namespace {

constexpr std::array pose_numbers{&pose::x_m, &pose::y_m, &pose::heading_deg};

double seconds_between(const path_point& from, const path_point& to) noexcept {
  return static_cast<double>(detail::saturating_sub(to.time_ns, from.time_ns)) * 1e-9;
}

}  // namespace

void smooth(std::span<path_point> path) noexcept {
  if (path.empty()) return;
  path.front().robot.per_s = path.back().robot.per_s = {};
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const double before_s = seconds_between(path[i - 1], path[i]);
    const double after_s = seconds_between(path[i], path[i + 1]);
    for (const auto coordinate : pose_numbers) {
      const double here = path[i].robot.at.*coordinate;
      const double before = (here - path[i - 1].robot.at.*coordinate) / before_s;
      const double after = (path[i + 1].robot.at.*coordinate - here) / after_s;
      double& speed = path[i].robot.per_s.*coordinate;
      speed = 0.0;
      if (before * after <= 0.0) continue;
      const double weight_before = 2.0 * after_s + before_s;
      const double weight_after = after_s + 2.0 * before_s;
      speed = (weight_before + weight_after) / (weight_before / before + weight_after / after);
    }
  }
}

moving_pose robot_at(std::span<const path_point> path, std::int64_t time_ns) noexcept {
  assert(!path.empty());
  if (time_ns <= path.front().time_ns) return {path.front().robot.at, {}};
  if (time_ns >= path.back().time_ns) return {path.back().robot.at, {}};
  const auto later = [](std::int64_t time, const path_point& point) {
    return time < point.time_ns;
  };
  const auto next = std::upper_bound(path.begin(), path.end(), time_ns, later);
  const path_point& from = *(next - 1);
  const path_point& to = *next;
  const double whole_s = seconds_between(from, to);
  const double s =
      static_cast<double>(detail::saturating_sub(time_ns, from.time_ns)) * 1e-9 / whole_s;
  moving_pose robot;
  for (const auto coordinate : pose_numbers) {
    // A robot that stands has exactly the same pose at all times.
    const double way = to.robot.at.*coordinate - from.robot.at.*coordinate;
    const double begins = from.robot.per_s.*coordinate * whole_s;
    const double ends = to.robot.per_s.*coordinate * whole_s;
    const double square = 3.0 * way - 2.0 * begins - ends;
    const double cube = begins + ends - 2.0 * way;
    robot.at.*coordinate = from.robot.at.*coordinate + s * (begins + s * (square + s * cube));
    robot.per_s.*coordinate = (begins + s * (2.0 * square + s * (3.0 * cube))) / whole_s;
  }
  return robot;
}

pose placed(const pose& a, const pose& b) noexcept {
  const sin_cos heading = sin_cos_deg(a.heading_deg);
  return {a.x_m + (heading.cosine * b.x_m - heading.sine * b.y_m),
          a.y_m + (heading.sine * b.x_m + heading.cosine * b.y_m), a.heading_deg + b.heading_deg};
}

}  // namespace g4lidar::sim
