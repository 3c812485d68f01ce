// SPDX-License-Identifier: MIT
// Motion in the plane: poses, constant twists, and paths of stamped poses.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <type_traits>

#include "g4lidar/core/correction.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/detail/saturating.hpp"

namespace g4lidar {

/// A position and a heading in the plane, or the place of one frame of reference in another. As in REP 103: x and y in
/// metres, yaw counter-clockwise from the x axis in radians.
struct pose_2d {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;

  friend constexpr bool operator==(const pose_2d&, const pose_2d&) noexcept = default;
};

/// A velocity in the moving frame: x forward, y to the left, yaw counter-clockwise.
struct twist_2d {
  double x_m_per_s = 0.0;
  double y_m_per_s = 0.0;
  double yaw_rad_per_s = 0.0;

  friend constexpr bool operator==(const twist_2d&, const twist_2d&) noexcept = default;
};

/// A pose at a time, in nanoseconds of the monotonic clock, as `point::time_ns`.
struct stamped_pose {
  std::int64_t time_ns = 0;
  pose_2d pose;
};

/// The maximum of a coordinate (metres) and of a yaw (radians) in odometry, in magnitude.
inline constexpr double max_odometry_value = 1e6;

/// What odometry contains about a time: the pose of the robot in a fixed frame, and its velocity in its own frame.
struct stamped_odometry {
  std::int64_t time_ns = 0;  ///< As in stamped_pose.
  pose_2d pose{};
  twist_2d twist{};

  friend constexpr bool operator==(const stamped_odometry&,
                                   const stamped_odometry&) noexcept = default;
};

/// How a lidar is fixed to a robot.
struct mounting {
  /// The place of the lidar's own frame (frame::robot) in the frame of the robot.
  pose_2d pose;
  /// Whether the lidar hangs with its top down: its angles grow the other way, seen from above.
  bool upside_down = false;

  /// `of` the lidar's own frame, as the twist of a frame at the same place with z up. *Pure.*
  [[nodiscard]] constexpr twist_2d upright(const twist_2d& of) const noexcept {
    return upside_down ? twist_2d{of.x_m_per_s, -of.y_m_per_s, -of.yaw_rad_per_s} : of;
  }
};

/// Sine and cosine in double precision.
struct rotation {
  double sine = 0.0;
  double cosine = 1.0;
};

namespace detail {

inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// The integer that is nearest to `x`; nothing if `x` is not a number, or not below 2^62 in magnitude.
[[nodiscard]] constexpr std::optional<std::int64_t> nearest(double x) noexcept {
  constexpr double beyond = 0x1p62;
  if (x != x || x >= beyond || x <= -beyond) return std::nullopt;
  return static_cast<std::int64_t>(x < 0.0 ? x - 0.5 : x + 0.5);
}

}  // namespace detail

/// The rotation by an angle in radians, below 1e6 in magnitude, without libm. *Pure.* Within 1e-15 of the true values.
/// That by another angle is less exact; from 2^62 quarter turns on, and of what is not a number, it is not a number.
[[nodiscard]] constexpr rotation rotation_by(double yaw_rad) noexcept {
  // The nearest multiple of a quarter turn is subtracted in two parts, the first one short enough for an exact product;
  // the rest, at most an eighth of a turn, goes into two series.
  constexpr double quarter_upper = 0x1.921fb544p0;
  constexpr double quarter_lower = 0x1.0b4611a626331p-34;
  const std::optional<std::int64_t> nearest = detail::nearest(yaw_rad * (2.0 / std::numbers::pi));
  if (!nearest) return {detail::not_a_number, detail::not_a_number};
  const std::int64_t quarters = *nearest;
  const double x = (yaw_rad - static_cast<double>(quarters) * quarter_upper) -
                   static_cast<double>(quarters) * quarter_lower;
  const double x2 = x * x;
  const double s =
      x + x * x2 *
              (-1.0 / 6 +
               x2 * (1.0 / 120 +
                     x2 * (-1.0 / 5040 +
                           x2 * (1.0 / 362880 +
                                 x2 * (-1.0 / 39916800 +
                                       x2 * (1.0 / 6227020800 + x2 * (-1.0 / 1307674368000)))))));
  const double c =
      1.0 +
      x2 * (-1.0 / 2 +
            x2 * (1.0 / 24 + x2 * (-1.0 / 720 +
                                   x2 * (1.0 / 40320 + x2 * (-1.0 / 3628800 +
                                                             x2 * (1.0 / 479001600 +
                                                                   x2 * (-1.0 / 87178291200 +
                                                                         x2 / 20922789888000)))))));
  switch (quarters & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

/// `yaw_rad`, below 1e6 in magnitude, as the same direction in [-pi, pi]. *Pure.* Another one as rotation_by().
[[nodiscard]] constexpr double wrap_rad(double yaw_rad) noexcept {
  const std::optional<std::int64_t> whole = detail::nearest(yaw_rad * (0.5 / std::numbers::pi));
  if (!whole) return detail::not_a_number;
  return yaw_rad - static_cast<double>(*whole) * (2.0 * std::numbers::pi);
}

/// The pose `b`, given in the frame of `a`, in the frame in which `a` is given. *Pure.* The yaw is wrapped.
[[nodiscard]] constexpr pose_2d operator*(const pose_2d& a, const pose_2d& b) noexcept {
  const rotation r = rotation_by(a.yaw_rad);
  return {a.x_m + r.cosine * b.x_m - r.sine * b.y_m, a.y_m + r.sine * b.x_m + r.cosine * b.y_m,
          wrap_rad(a.yaw_rad + b.yaw_rad)};
}

/// The pose with which `pose` gives the origin: pose * inverse(pose) == {}. *Pure.*
[[nodiscard]] constexpr pose_2d inverse(const pose_2d& pose) noexcept {
  const rotation r = rotation_by(pose.yaw_rad);
  return {-(r.cosine * pose.x_m + r.sine * pose.y_m), r.sine * pose.x_m - r.cosine * pose.y_m,
          wrap_rad(-pose.yaw_rad)};
}

namespace detail {

/// sin(a) / a and (1 - cos(a)) / a.
struct arc_factors {
  double along;
  double across;
};
[[nodiscard]] constexpr arc_factors arc_factors_of(double a) noexcept {
  if (a < 0.02 && a > -0.02) {  // the series: the next terms are below 1e-16
    const double a2 = a * a;
    return {1.0 - a2 / 6.0 * (1.0 - a2 / 20.0 * (1.0 - a2 / 42.0)),
            a / 2.0 * (1.0 - a2 / 12.0 * (1.0 - a2 / 30.0 * (1.0 - a2 / 56.0)))};
  }
  const rotation r = rotation_by(a);
  return {r.sine / a, (1.0 - r.cosine) / a};
}

}  // namespace detail

/// Where a frame is after it moved from the origin with a constant twist for `seconds`, which may be negative. *Pure.*
[[nodiscard]] constexpr pose_2d moved_by(const twist_2d& twist, double seconds) noexcept {
  const double turn = twist.yaw_rad_per_s * seconds;
  const auto [along, across] = detail::arc_factors_of(turn);
  const double x = twist.x_m_per_s * seconds;
  const double y = twist.y_m_per_s * seconds;
  return {along * x - across * y, across * x + along * y, wrap_rad(turn)};
}

/// The constant twist that moves a frame from the origin to `pose` in `seconds`, not 0, by less than half a turn.
/// *Pure.* The inverse of moved_by().
[[nodiscard]] constexpr twist_2d twist_to(const pose_2d& pose, double seconds) noexcept {
  const double turn = wrap_rad(pose.yaw_rad);
  const auto [along, across] = detail::arc_factors_of(turn);
  const double square = along * along + across * across;
  return {(along * pose.x_m + across * pose.y_m) / square / seconds,
          (along * pose.y_m - across * pose.x_m) / square / seconds, turn / seconds};
}

/// `twist`, that of a robot, as the twist of a frame with the fixed place `pose` on it. *Pure.*
[[nodiscard]] constexpr twist_2d seen_from(const pose_2d& pose, const twist_2d& twist) noexcept {
  const rotation r = rotation_by(pose.yaw_rad);
  const double x = twist.x_m_per_s - twist.yaw_rad_per_s * pose.y_m;
  const double y = twist.y_m_per_s + twist.yaw_rad_per_s * pose.x_m;
  return {r.cosine * x + r.sine * y, r.cosine * y - r.sine * x, twist.yaw_rad_per_s};
}

/// The place between two stamped poses, reached with a constant twist from the first to the second; `time_ns` may be
/// outside of both. *Pure.* If both have the same time, the pose of the first one.
[[nodiscard]] constexpr pose_2d interpolated(const stamped_pose& from, const stamped_pose& to,
                                             std::int64_t time_ns) noexcept {
  if (from.time_ns == to.time_ns) return from.pose;
  const auto whole = static_cast<double>(detail::saturating_sub(to.time_ns, from.time_ns));
  const auto part = static_cast<double>(detail::saturating_sub(time_ns, from.time_ns));
  return from.pose * moved_by(twist_to(inverse(from.pose) * to.pose, whole), part);
}

/// The index of a pose of `path` (times ascending) such that `time_ns` is not before it and not after the next one; no
/// value if the time is not within the path. At the time of a pose it may be that of the piece before or after it.
/// *Pure.* `guess` is tried first, then the next index, then a binary search.
[[nodiscard]] constexpr std::optional<std::size_t> piece_at(std::span<const stamped_pose> path,
                                                            std::int64_t time_ns,
                                                            std::size_t guess = 0) noexcept {
  if (path.size() < 2 || time_ns < path.front().time_ns || time_ns > path.back().time_ns)
    return std::nullopt;
  const auto has = [&](std::size_t i) {
    return path[i].time_ns <= time_ns && time_ns <= path[i + 1].time_ns;
  };
  const std::size_t last = path.size() - 2;
  if (guess <= last && has(guess)) return guess;
  if (guess < last && has(guess + 1)) return guess + 1;
  std::size_t low = 0;
  std::size_t high = path.size() - 1;
  while (high - low > 1) {
    const std::size_t middle = low + (high - low) / 2;
    (path[middle].time_ns <= time_ns ? low : high) = middle;
  }
  return low;
}

/// The pose on `path` (times ascending) at `time_ns`, interpolated; no value if the path does not contain the time.
/// *Pure.*
[[nodiscard]] constexpr std::optional<pose_2d> pose_at(std::span<const stamped_pose> path,
                                                       std::int64_t time_ns) noexcept {
  const auto piece = piece_at(path, time_ns);
  if (!piece) return std::nullopt;
  return interpolated(path[*piece], path[*piece + 1], time_ns);
}

/// A function of a time in nanoseconds that returns the pose of the robot in a fixed frame, or a std::optional of it. It
/// may be called more than once for a time.
template <class Function>
concept motion_function = std::invocable<const Function&, std::int64_t> &&
                          std::convertible_to<std::invoke_result_t<const Function&, std::int64_t>,
                                              std::optional<pose_2d>>;

}  // namespace g4lidar
