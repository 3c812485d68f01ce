// SPDX-License-Identifier: MIT
// Deskewing once more, in double precision and with libm, by places in the fixed frame: no relative poses, no blocks.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar::test {

/// A place in the plane, in millimetres.
struct place_mm {
  double x;
  double y;
};

/// `at`, given in the frame of `frame_pose`, in the fixed frame.
[[nodiscard]] inline place_mm out_of(const pose_2d& frame_pose, place_mm at) {
  const double s = std::sin(frame_pose.yaw_rad);
  const double c = std::cos(frame_pose.yaw_rad);
  return {frame_pose.x_m * 1000.0 + c * at.x - s * at.y,
          frame_pose.y_m * 1000.0 + s * at.x + c * at.y};
}
/// The inverse.
[[nodiscard]] inline place_mm into(const pose_2d& frame_pose, place_mm at) {
  const double s = std::sin(frame_pose.yaw_rad);
  const double c = std::cos(frame_pose.yaw_rad);
  const double x = at.x - frame_pose.x_m * 1000.0;
  const double y = at.y - frame_pose.y_m * 1000.0;
  return {c * x + s * y, c * y - s * x};
}

/// The pose of the robot after a constant twist from `start`, by the closed form.
[[nodiscard]] inline pose_2d driven(const pose_2d& start, const twist_2d& twist, double seconds) {
  const double turn = twist.yaw_rad_per_s * seconds;
  // The chord of an arc: its direction is that of the velocity half way, its length sin(a / 2) / (a / 2) of the arc.
  const double half = turn / 2.0;
  const double shorter = std::fabs(half) < 1e-9 ? 1.0 : std::sin(half) / half;
  const double direction = start.yaw_rad + half;
  const double x = twist.x_m_per_s * seconds * shorter;
  const double y = twist.y_m_per_s * seconds * shorter;
  return {start.x_m + std::cos(direction) * x - std::sin(direction) * y,
          start.y_m + std::sin(direction) * x + std::cos(direction) * y, start.yaw_rad + turn};
}

/// A point of a lidar with this turn in the frame of its robot, while the robot is where its frame is.
[[nodiscard]] inline place_mm on_robot(double angle_deg, double range_mm, const mounting& mount,
                                       double turn_deg = 180.0) {
  const double bearing = (turn_deg - angle_deg) * (std::numbers::pi / 180.0);
  const double side = mount.upside_down ? -1.0 : 1.0;
  return out_of(mount.pose, {range_mm * std::cos(bearing), side * range_mm * std::sin(bearing)});
}

/// A direction in degrees (any turn) and a range in millimetres, in the frame of the lidar.
struct direction_and_range {
  double angle_deg;
  double range_mm;
};

/// The inverse of on_robot().
[[nodiscard]] inline direction_and_range from_robot(place_mm at, const mounting& mount,
                                                    double turn_deg = 180.0) {
  const place_mm own = into(mount.pose, at);
  const double side = mount.upside_down ? -1.0 : 1.0;
  return {turn_deg - std::atan2(side * own.y, own.x) * (180.0 / std::numbers::pi),
          std::hypot(own.x, own.y)};
}

/// `p`, measured while the robot was at `then`, as seen from the lidar while the robot is at `reference`.
[[nodiscard]] inline direction_and_range seen_again(const point& p, const pose_2d& then,
                                                    const pose_2d& reference, const mounting& mount,
                                                    double turn_deg = 180.0) {
  if (p.is_no_return()) {
    const double turn = (then.yaw_rad - reference.yaw_rad) * (180.0 / std::numbers::pi);
    return {static_cast<double>(p.angle_deg) + (mount.upside_down ? turn : -turn), 0.0};
  }
  const place_mm fixed = out_of(then, on_robot(static_cast<double>(p.angle_deg),
                                               static_cast<double>(p.range_mm), mount, turn_deg));
  return from_robot(into(reference, fixed), mount, turn_deg);
}

/// The way of the lidar between two poses of the robot, in millimetres.
[[nodiscard]] inline double way_mm(const pose_2d& then, const pose_2d& reference,
                                   const mounting& mount) {
  const place_mm lidar{mount.pose.x_m * 1000.0, mount.pose.y_m * 1000.0};
  const place_mm a = out_of(then, lidar);
  const place_mm b = out_of(reference, lidar);
  return std::hypot(a.x - b.x, a.y - b.y);
}

}  // namespace g4lidar::test
