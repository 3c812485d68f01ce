// SPDX-License-Identifier: MIT
// Where a lidar on a moving robot was at the times of points, seen from where it was at a reference time.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "g4lidar/detail/point_block.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar::detail {

/// A constant twist, at the times from `first_ns` to `last_ns`. All in the lidar's own frame; see point_block.
struct constant_motion {
  pose_2d start;  ///< The place at `start_ns`.
  twist_2d twist;
  std::int64_t start_ns = 0;
  std::int64_t first_ns = std::numeric_limits<std::int64_t>::min();
  std::int64_t last_ns = std::numeric_limits<std::int64_t>::max();

  [[nodiscard]] constexpr bool has(std::int64_t time_ns) const noexcept {
    return first_ns <= time_ns && time_ns <= last_ns;
  }

  /// Loads the points at the front of `points` whose times are known, within the limits, and near enough to that of the
  /// first one, with their places, and returns their number.
  [[nodiscard]] constexpr std::size_t load(std::span<const point> points,
                                           point_block& block) const noexcept {
    const std::int64_t begin_ns = points.front().time_ns;
    if (begin_ns == 0 || !has(begin_ns)) return 0;
    // At most 1 second and 0.02 radians from the first point, where the series of set_places() are exact.
    const double rate = twist.yaw_rad_per_s < 0.0 ? -twist.yaw_rad_per_s : twist.yaw_rad_per_s;
    const auto reach_ns = static_cast<std::int64_t>(rate > 0.02 ? 0.02e9 / rate : 1e9);
    std::int64_t low_ns = std::max(first_ns, saturating_sub(begin_ns, reach_ns));
    std::int64_t high_ns = std::min(last_ns, saturating_add(begin_ns, reach_ns));
    // 0 is no time.
    if (begin_ns > 0) low_ns = std::max<std::int64_t>(low_ns, 1);
    if (begin_ns < 0) high_ns = std::min<std::int64_t>(high_ns, -1);

    const std::size_t most = std::min(points.size(), point_block::capacity);
    std::size_t count = 0;
    for (; count < most; ++count) {
      const point& p = points[count];
      if (p.time_ns < low_ns || p.time_ns > high_ns) break;
      block.load(count, p);
      block.since_ns[count] = static_cast<std::int32_t>(p.time_ns - begin_ns);
    }
    const double seconds = static_cast<double>(saturating_sub(begin_ns, start_ns)) * 1e-9;
    block.set_places(start * moved_by(twist, seconds), twist, count);
    return count;
  }
};

/// From where the points are to be seen.
enum class viewpoint : std::uint8_t {
  lidar,  ///< From where the lidar was at the reference time.
  robot,  ///< From the origin of the robot at the reference time; the lidar has its top up.
};

/// A lidar on a robot, and from where its points are to be seen.
struct mounted_view {
  mounting mount;
  std::uint16_t turn_deg = g4_model.turn_deg;  ///< Of the lidar.
  viewpoint seen = viewpoint::lidar;

  [[nodiscard]] constexpr vendor_axes axes() const noexcept {
    return {mount.upside_down, turn_deg};
  }
};

/// A constant twist of the robot.
[[nodiscard]] constexpr constant_motion motion_by_twist(const twist_2d& twist,
                                                        std::int64_t reference_ns,
                                                        const mounted_view& view) noexcept {
  const pose_2d start = view.seen == viewpoint::robot ? view.mount.pose : pose_2d{};
  return {.start = view.axes()(start),
          .twist = view.axes()(seen_from(view.mount.pose, twist)),
          .start_ns = reference_ns};
}

/// Poses of the robot in a fixed frame, as places of the lidar.
class seen_places {
 public:
  constexpr seen_places(const std::optional<pose_2d>& reference, const mounted_view& view) noexcept
      : known_(reference), mounted_at_(view.mount.pose), axes_(view.axes()) {
    if (!reference) return;
    from_reference_ =
        inverse(view.seen == viewpoint::robot ? *reference : *reference * mounted_at_);
  }
  /// Whether there is a pose for the reference time.
  [[nodiscard]] constexpr bool known() const noexcept { return known_; }
  [[nodiscard]] constexpr pose_2d place(const pose_2d& robot) const noexcept {
    return axes_(from_reference_ * (robot * mounted_at_));
  }
  [[nodiscard]] constexpr twist_2d twist(const twist_2d& robot) const noexcept {
    return axes_(seen_from(mounted_at_, robot));
  }

 private:
  bool known_;
  pose_2d mounted_at_;
  vendor_axes axes_;
  pose_2d from_reference_;
};

/// The pieces of a path.
class motion_on_path {
 public:
  constexpr motion_on_path(std::span<const stamped_pose> path, std::int64_t reference_ns,
                           const mounted_view& view) noexcept
      : path_(path), places_(pose_at(path, reference_ns), view) {}

  /// As constant_motion::load().
  [[nodiscard]] constexpr std::size_t load(std::span<const point> points,
                                           point_block& block) noexcept {
    const std::int64_t time_ns = points.front().time_ns;
    if (time_ns == 0 || !places_.known()) return 0;
    if (!has_piece_ || !piece_.has(time_ns)) {
      const auto index = piece_at(path_, time_ns, index_);
      if (!index) return 0;
      enter(*index);
    }
    return piece_.load(points, block);
  }

 private:
  constexpr void enter(std::size_t index) noexcept {
    const stamped_pose& from = path_[index];
    const stamped_pose& to = path_[index + 1];
    const double seconds = static_cast<double>(saturating_sub(to.time_ns, from.time_ns)) * 1e-9;
    const twist_2d robot =
        seconds > 0.0 ? twist_to(inverse(from.pose) * to.pose, seconds) : twist_2d{};
    piece_ = {places_.place(from.pose), places_.twist(robot), from.time_ns, from.time_ns,
              to.time_ns};
    index_ = index;
    has_piece_ = true;
  }

  std::span<const stamped_pose> path_;
  seen_places places_;
  constant_motion piece_;
  std::size_t index_ = 0;
  bool has_piece_ = false;
};

/// A function of time.
template <class Function>
class motion_by_function {
 public:
  constexpr motion_by_function(const Function& function, std::int64_t reference_ns,
                               const mounted_view& view)
      : function_(&function), places_(function(reference_ns), view) {}

  /// As constant_motion::load().
  [[nodiscard]] constexpr std::size_t load(std::span<const point> points, point_block& block) {
    const std::size_t most = places_.known() ? std::min(points.size(), point_block::capacity) : 0;
    std::size_t count = 0;
    for (; count < most && points[count].time_ns != 0; ++count) {
      const std::optional<pose_2d> robot = (*function_)(points[count].time_ns);
      if (!robot) break;
      block.load(count, points[count]);
      block.set_place(count, places_.place(*robot));
    }
    return count;
  }

 private:
  const Function* function_;
  seen_places places_;
};

/// Moves `points` to the front of `out`. `motion.load(rest, block)` loads some points at the front of `rest` with their
/// places and returns their number, 0 if the first one has none. Such a point stays where it is, or is seen from
/// `standing`, and is flagged not_deskewed. Returns the number of these points.
template <class Motion>
constexpr std::size_t move_points(std::span<const point> points, std::span<point> out,
                                  Motion motion, const std::optional<pose_2d>& standing = {}) {
  assert(out.size() >= points.size());
  point_block block;
  std::size_t outside = 0;
  for (std::size_t at = 0; at < points.size();) {
    const std::size_t loaded = motion.load(points.subspan(at), block);
    const std::size_t count = std::max<std::size_t>(loaded, 1);
    if (loaded == 0) {
      ++outside;
      block.load(0, points[at]);
      block.set_place(0, standing.value_or(pose_2d{}));
    }
    if (loaded > 0 || standing) block.move(count);
    block.store(points.subspan(at, count), out.subspan(at, count));
    if (loaded == 0) out[at].flags = out[at].flags | point_flags::not_deskewed;
    at += count;
  }
  return outside;
}

}  // namespace g4lidar::detail
