// SPDX-License-Identifier: MIT
#include "odometry_feed.hpp"

#include <algorithm>
#include <utility>

#include "input.hpp"
#include "odometry_file.hpp"

namespace g4_tool {

void odometry_feed::follow(const sim::simulated_source* carried) {
  robot_ = carried == nullptr ? std::nullopt : carried->robot;
  begin_ns_ = robot_ ? carried->begin_ns : 0;
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

void odometry_feed::load_recording(const std::string& path) {
  all_.clear();
  read_items(path, {}, [this](const recorded_item& item) {
    if (item.what == recorded_item::kind::odometry) all_.push_back(item.odometry);
    return true;
  });
  std::ranges::sort(all_, {}, &stamped_odometry::time_ns);
  const auto same = std::ranges::unique(all_, {}, &stamped_odometry::time_ns);
  all_.erase(same.begin(), same.end());
}

void odometry_feed::shift(std::int64_t shift_ns) {
  for (stamped_odometry& each : all_) each.time_ns += shift_ns;
}

void odometry_feed::follow(std::span<const point> points, const taker& take) {
  if (points.empty()) return;
  if (all_.empty() && robot_) return follow_robot(points, take);
  if (all_.empty()) return;
  if (!std::exchange(has_begun_, true)) {
    const auto first =
        std::ranges::upper_bound(all_, points.front().time_ns, {}, &stamped_odometry::time_ns);
    next_ = static_cast<std::size_t>(first - all_.begin()) - (first == all_.begin() ? 0 : 1);
  }
  while (next_ < all_.size()) {
    if (next_ > 0 && all_[next_ - 1].time_ns >= points.back().time_ns) return;
    take(all_[next_++]);
  }
}

void odometry_feed::follow_robot(std::span<const point> points, const taker& take) {
  while (last_ns_ < points.back().time_ns) {
    const sim::odometry_sample at = robot_->next();
    const std::int64_t time_ns = at.time_ns + begin_ns_;
    // What was before the first point is of no use.
    if (has_begun_ || robot_->next_ns() + begin_ns_ > points.front().time_ns) {
      has_begun_ = true;
      take({time_ns,
            {at.x_m, at.y_m, at.yaw_rad},
            {at.forward_m_per_s, at.left_m_per_s, at.yaw_rad_per_s}});
    }
    last_ns_ = time_ns;
  }
}

}  // namespace g4_tool
