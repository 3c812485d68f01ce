// SPDX-License-Identifier: MIT
#include "odometry_feed.hpp"

#include <algorithm>
#include <utility>

#include "shape_files.hpp"

namespace g4_tool {
namespace {

/// Times of points that go back by less do so by the error of the clock.
constexpr std::int64_t least_way_back_ns = 100'000'000;

}  // namespace

void odometry_feed::follow(const sim::simulated_source* carried) {
  robot_ = carried == nullptr ? std::nullopt : carried->robot;
  begin_ns_ = robot_ ? carried->begin_ns : 0;
  has_begun_ = false;
}

void odometry_feed::follow(g4lidar::player& played) {
  player_ = &played;
  begin_ns_ = played.begin_ns();
}

void odometry_feed::load(const std::string& path) {
  for (const stamped_pose& pose : load_odometry(path)) {
    twist_2d twist;
    if (!all_.empty()) {
      const stamped_odometry& before = all_.back();
      const double seconds = static_cast<double>(pose.time_ns - before.time_ns) * 1e-9;
      twist = twist_to(inverse(before.pose) * pose.pose, seconds);
    }
    all_.push_back({pose.time_ns, pose.pose, twist});
  }
}

void odometry_feed::load_recording(const std::string& path) { all_ = recorded_odometry(path); }

void odometry_feed::shift(std::int64_t shift_ns) {
  for (stamped_odometry& each : all_) each.time_ns += shift_ns;
}

void odometry_feed::follow_round(std::int64_t time_ns) {
  // Points are a little older than their bytes, and rounds are further apart.
  constexpr std::int64_t largest_age_ns = 5'000'000;
  const std::int64_t begin_ns = player_->begin_ns();
  if (begin_ns == begin_ns_ || time_ns < begin_ns - largest_age_ns) return;
  shift(begin_ns - std::exchange(begin_ns_, begin_ns));
  has_begun_ = false;
}

void odometry_feed::follow(std::span<const point> points, const taker& take) {
  if (points.empty()) return;
  if (player_ != nullptr) follow_round(points.front().time_ns);
  const std::int64_t before_ns = std::exchange(points_ns_, points.front().time_ns);
  if (points_ns_ < before_ns - least_way_back_ns) has_begun_ = false;  // a seek
  if (all_.empty() && robot_) return follow_robot(*robot_, points, take);
  if (all_.empty()) return;
  if (!std::exchange(has_begun_, true)) {
    ++begun_;
    const auto first =
        std::ranges::upper_bound(all_, points.front().time_ns, {}, &stamped_odometry::time_ns);
    next_ = static_cast<std::size_t>(first - all_.begin()) - (first == all_.begin() ? 0 : 1);
  }
  while (next_ < all_.size()) {
    if (next_ > 0 && all_[next_ - 1].time_ns >= points.back().time_ns) return;
    take(all_[next_++]);
  }
}

void odometry_feed::follow_robot(sim::odometry& robot, std::span<const point> points,
                                 const taker& take) {
  while (last_ns_ < points.back().time_ns) {
    const sim::odometry_sample at = robot.next();
    const std::int64_t time_ns = at.time_ns + begin_ns_;
    // What was before the first point is of no use.
    if (has_begun_ || robot.next_ns() + begin_ns_ > points.front().time_ns) {
      if (!std::exchange(has_begun_, true)) ++begun_;
      take({time_ns,
            {at.x_m, at.y_m, at.yaw_rad},
            {at.forward_m_per_s, at.left_m_per_s, at.yaw_rad_per_s}});
    }
    last_ns_ = time_ns;
  }
}

}  // namespace g4_tool
