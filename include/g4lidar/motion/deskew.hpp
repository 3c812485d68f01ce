// SPDX-License-Identifier: MIT
// Deskewing: each point as the lidar would have seen it from where it was at one reference time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "g4lidar/detail/lidar_motion.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar {

/// What deskew() made.
struct deskewed {
  std::span<point> points;  ///< All points, in the order in which they were given.
  std::size_t outside = 0;  ///< How many of them are flagged not_deskewed.
};

/// The points as seen from where the lidar was at `reference_ns`, while the robot moved with a constant twist.
///
/// The results are in the lidar's own frame, as the points are: `angle_deg` and `range_mm` are those that the lidar
/// would have measured from that place. `time_ns` and `revolution` stay. Of a point without return only the direction
/// turns. The flags stay those of the measurement: a return whose range falls below the shortest one is not flagged
/// too_near. `turn_deg` is that of the model, 0 or 180; the default is the G4's.
///
/// A point with `time_ns` 0, or at whose time the motion has no pose, is copied as it is, flagged not_deskewed, and
/// counted; without a pose for `reference_ns`, this is every point. A point that is deskewed loses that flag. Because
/// its time stays that of the measurement, it must not be deskewed again.
///
/// `out` is at least as long as `points`, and may begin where `points` begins. Results are within 0.01 mm and 1e-6 of
/// the range, and within 1e-4 degrees, if the lidar moved by less than half of the range; else within 0.01 mm and 3e-6
/// of the sum of range and way. Times are below 2^62 in magnitude; numbers are finite, and no yaw exceeds 1e6 radians.
/// Uses 2 KiB of stack. *Pure, never allocates.*
constexpr deskewed deskew(std::span<const point> points, const twist_2d& twist,
                          std::int64_t reference_ns, std::span<point> out,
                          const mounting& mount = {},
                          std::uint16_t turn_deg = g4_model.turn_deg) noexcept {
  return {out.first(points.size()),
          detail::move_points(points, out,
                              detail::motion_by_twist(twist, reference_ns, {mount, turn_deg}))};
}

/// The same with poses of the robot in a fixed frame, times ascending. Between two poses the twist is constant. There
/// are no poses before the first time and after the last one.
constexpr deskewed deskew(std::span<const point> points, std::span<const stamped_pose> path,
                          std::int64_t reference_ns, std::span<point> out,
                          const mounting& mount = {},
                          std::uint16_t turn_deg = g4_model.turn_deg) noexcept {
  return {out.first(points.size()),
          detail::move_points(points, out,
                              detail::motion_on_path(path, reference_ns, {mount, turn_deg}))};
}

/// The same with a function that gives the pose at a time; slower, because it is called for each point.
template <motion_function Function>
constexpr deskewed deskew(std::span<const point> points, const Function& motion,
                          std::int64_t reference_ns, std::span<point> out,
                          const mounting& mount = {}, std::uint16_t turn_deg = g4_model.turn_deg) {
  return {out.first(points.size()),
          detail::move_points(
              points, out,
              detail::motion_by_function<Function>(motion, reference_ns, {mount, turn_deg}))};
}

/// The same, in place.
constexpr deskewed deskew(std::span<point> points, const twist_2d& twist, std::int64_t reference_ns,
                          const mounting& mount = {},
                          std::uint16_t turn_deg = g4_model.turn_deg) noexcept {
  return deskew(points, twist, reference_ns, points, mount, turn_deg);
}
/// The same, in place.
constexpr deskewed deskew(std::span<point> points, std::span<const stamped_pose> path,
                          std::int64_t reference_ns, const mounting& mount = {},
                          std::uint16_t turn_deg = g4_model.turn_deg) noexcept {
  return deskew(points, path, reference_ns, points, mount, turn_deg);
}
/// The same, in place.
template <motion_function Function>
constexpr deskewed deskew(std::span<point> points, const Function& motion,
                          std::int64_t reference_ns, const mounting& mount = {},
                          std::uint16_t turn_deg = g4_model.turn_deg) {
  return deskew(std::span<const point>(points), motion, reference_ns, points, mount, turn_deg);
}

}  // namespace g4lidar
