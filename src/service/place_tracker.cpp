// SPDX-License-Identifier: MIT
#include "service/place_tracker.hpp"

#include <utility>

#include "g4lidar/detail/saturating.hpp"

namespace g4lidar {
namespace {

using detail::saturating_sub;

/// So long the frame is taken to keep its velocity where the scans do not show it; a longer gap begins another map.
constexpr std::int64_t longest_gap_ns = 1'000'000'000;

double seconds_of(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }

}  // namespace

std::optional<lidar_place> place_tracker::by_path(std::span<const g4lidar::stamped_pose> path,
                                                  const pose_2d& mount, std::int64_t time_ns,
                                                  std::uint64_t begun) {
  const auto robot = pose_at(path, time_ns);
  if (!robot) return std::nullopt;
  const pose_2d pose = *robot * mount;
  // The frame of the odometry is the same one, but the way is another one.
  if (std::exchange(begun_, begun) != begun) ++map_;
  last_ = {time_ns, pose};
  return lidar_place{pose, map_};
}

std::optional<lidar_place> place_tracker::by_twist(const std::optional<twist_2d>& twist,
                                                   std::int64_t time_ns) {
  const bool continues = last_ && time_ns > last_->time_ns &&
                         saturating_sub(time_ns, last_->time_ns) <= longest_gap_ns;
  if (!continues) last_.reset();
  const twist_2d before = velocity_;
  if (twist) {
    velocity_ = *twist;
    known_ns_ = time_ns;
  } else if (!last_ || saturating_sub(time_ns, known_ns_) > longest_gap_ns) {
    last_.reset();
    return std::nullopt;
  }
  if (last_) {
    // Each velocity is the mean of two revolutions, at the time between them.
    const twist_2d mean{(before.x_m_per_s + velocity_.x_m_per_s) / 2,
                        (before.y_m_per_s + velocity_.y_m_per_s) / 2,
                        (before.yaw_rad_per_s + velocity_.yaw_rad_per_s) / 2};
    last_->pose = last_->pose * moved_by(mean, seconds_of(saturating_sub(time_ns, last_->time_ns)));
  } else {
    last_.emplace();
    ++map_;
  }
  last_->time_ns = time_ns;
  return lidar_place{last_->pose, map_};
}

}  // namespace g4lidar
