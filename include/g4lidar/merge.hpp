// SPDX-License-Identifier: MIT
// Merging: the scans of several lidars on one robot as one scan of a lidar at the robot's origin.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "g4lidar/core/angle.hpp"
#include "g4lidar/detail/lidar_motion.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar {

/// One of several lidars on a robot.
struct mounted_scan {
  std::span<const point> points;  ///< Its newest complete scan; empty if there is none.
  mounting mount;
  std::uint16_t turn_deg = g4_model.turn_deg;  ///< That of its model, 0 or 180.
};

/// What merge_scans() made.
struct merged {
  std::span<point> points;  ///< Those of the first lidar, then those of the second one, and so on.
  std::size_t outside = 0;  ///< How many of them are flagged not_deskewed.
  std::uint32_t lost = 0;   ///< Bit i is set if lidar i has no fresh scan; it gives no points.

  /// Whether lidar `i` has no fresh scan; one beyond the last possible one has none. *Pure.*
  [[nodiscard]] constexpr bool is_lost(std::size_t i) const noexcept {
    return i >= 32 || (lost >> i & 1U) != 0;
  }
};

/// How long before or after the reference time a scan may end, in nanoseconds: two and a half turns at 5 Hz.
inline constexpr std::int64_t fresh_scan_ns = 500'000'000;

namespace detail {

/// `make(view)` gives the places of a lidar that is mounted so.
template <class Make>
constexpr merged merge_scans(std::span<const mounted_scan> lidars, std::int64_t reference_ns,
                             std::span<point> out, std::int64_t fresh_ns, const Make& make) {
  assert(lidars.size() <= 32);
  merged result;
  std::size_t count = 0;
  for (std::size_t i = 0; i < lidars.size(); ++i) {
    const std::span<const point> scan = lidars[i].points;
    const std::int64_t end_ns = scan.empty() ? 0 : scan.back().time_ns;
    if (end_ns == 0 || end_ns < saturating_sub(reference_ns, fresh_ns) ||
        end_ns > saturating_add(reference_ns, fresh_ns)) {
      result.lost |= std::uint32_t{1} << i;
      continue;
    }
    assert(out.size() - count >= scan.size());
    const std::span<point> here = out.subspan(count, scan.size());
    std::copy(scan.begin(), scan.end(), here.begin());
    // As directions of a lidar with the turn of a G4 and its top up.
    const float side = lidars[i].mount.upside_down ? -1.0F : 1.0F;
    const auto turn = static_cast<float>(g4_model.turn_deg - lidars[i].turn_deg);
    for (point& p : here) p.angle_deg = wrap_once_deg(turn + side * p.angle_deg);
    const mounted_view view{.mount = {lidars[i].mount.pose, false}, .seen = viewpoint::robot};
    result.outside += move_points(here, here, make(view), view.axes()(view.mount.pose));
    count += scan.size();
  }
  result.points = out.first(count);
  return result;
}

}  // namespace detail

/// The scans of up to 32 lidars as one scan, deskewed with the constant twist of the robot to `reference_ns`.
///
/// The points are those that a G4 at the origin of the robot, with its top up, would have measured at that time:
/// to_xy(), fill_grid() and filters give and take the robot's own frame with frame::robot and their default turn. A lidar
/// may be mounted upside down, have any turn, and turn at any frequency. `time_ns`, `revolution` and flags are those of the measurement. The direction of a
/// point without return is that of an infinitely distant target. A lidar is lost if it has no points or if the time of
/// the last one is not known or farther than `fresh_ns` from `reference_ns`; the others are merged.
///
/// A point whose time is not known, or at whose time the motion has no pose, is placed as if the robot had not moved
/// since, flagged not_deskewed and counted. `out` is at least as long as all scans together, and apart from them. Bounds
/// and limits are those of deskew(), with the way from the robot's origin at `reference_ns` to the lidar. *Pure, never
/// allocates.*
constexpr merged merge_scans(std::span<const mounted_scan> lidars, const twist_2d& twist,
                             std::int64_t reference_ns, std::span<point> out,
                             std::int64_t fresh_ns = fresh_scan_ns) noexcept {
  return detail::merge_scans(lidars, reference_ns, out, fresh_ns,
                             [&](const detail::mounted_view& view) {
                               return detail::motion_by_twist(twist, reference_ns, view);
                             });
}

/// The same with poses of the robot in a fixed frame, times ascending.
constexpr merged merge_scans(std::span<const mounted_scan> lidars,
                             std::span<const stamped_pose> path, std::int64_t reference_ns,
                             std::span<point> out, std::int64_t fresh_ns = fresh_scan_ns) noexcept {
  return detail::merge_scans(lidars, reference_ns, out, fresh_ns,
                             [&](const detail::mounted_view& view) {
                               return detail::motion_on_path(path, reference_ns, view);
                             });
}

/// The same with a function that gives the pose at a time.
template <motion_function Function>
constexpr merged merge_scans(std::span<const mounted_scan> lidars, const Function& motion,
                             std::int64_t reference_ns, std::span<point> out,
                             std::int64_t fresh_ns = fresh_scan_ns) {
  return detail::merge_scans(
      lidars, reference_ns, out, fresh_ns, [&](const detail::mounted_view& view) {
        return detail::motion_by_function<Function>(motion, reference_ns, view);
      });
}

}  // namespace g4lidar
