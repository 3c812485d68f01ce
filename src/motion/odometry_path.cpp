// SPDX-License-Identifier: MIT
#include "g4lidar/scan_shaper.hpp"

#include <utility>

#include "g4lidar/detail/saturating.hpp"

namespace g4lidar {
namespace {

constexpr std::int64_t kept_path_ns = 5'000'000'000;
/// So long a robot is taken to keep its velocity.
constexpr std::int64_t longest_guess_ns = 200'000'000;

}  // namespace

void odometry_path::add(const stamped_odometry& now) {
  if (std::exchange(is_last_guessed_, false)) poses_.pop_back();
  if (newest_ && now.time_ns <= newest_->time_ns) poses_.clear();
  newest_ = now;
  std::erase_if(poses_, [&now](const stamped_pose& old) {
    return old.time_ns < detail::saturating_sub(now.time_ns, kept_path_ns);
  });
  poses_.push_back({now.time_ns, now.pose});
}

std::span<const stamped_pose> odometry_path::until(std::int64_t time_ns) {
  if (std::exchange(is_last_guessed_, false)) poses_.pop_back();
  const std::int64_t since_ns = newest_ ? detail::saturating_sub(time_ns, newest_->time_ns) : 0;
  if (since_ns > 0 && since_ns <= longest_guess_ns) {
    const double seconds = static_cast<double>(since_ns) * 1e-9;
    poses_.push_back({time_ns, newest_->pose * moved_by(newest_->twist, seconds)});
    is_last_guessed_ = true;
  }
  return poses_;
}

}  // namespace g4lidar
