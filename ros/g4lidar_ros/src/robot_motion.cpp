// SPDX-License-Identifier: MIT
#include "robot_motion.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <geometry_msgs/msg/transform_stamped.hpp>

#include "g4lidar/recording/reader.hpp"
#include "g4lidar/source.hpp"

namespace g4lidar_ros {
namespace {

/// Poses are looked up in tf so far apart.
constexpr std::int64_t tf_step_ns = 20'000'000;

std::vector<g4lidar::stamped_odometry> odometry_in(const std::string& source) {
  std::vector<g4lidar::stamped_odometry> all;
  auto reader = g4lidar::recording_reader::open(g4lidar::path_of_source(source));
  if (!reader) return all;  // it is reported when it is opened as a lidar
  const auto read = reader->for_each([&all](const g4lidar::recorded_item& item) {
    if (item.what == g4lidar::recorded_item::kind::odometry) all.push_back(item.odometry);
    return true;
  });
  static_cast<void>(read);  // what is damaged is left out
  std::ranges::sort(all, {}, &g4lidar::stamped_odometry::time_ns);
  const auto same = std::ranges::unique(all, {}, &g4lidar::stamped_odometry::time_ns);
  all.erase(same.begin(), same.end());
  return all;
}

void set(geometry_msgs::msg::Quaternion& turn, double yaw_rad, bool is_turned) {
  const auto [sine, cosine] = g4lidar::rotation_by(g4lidar::wrap_rad(yaw_rad) / 2.0);
  turn.x = is_turned ? cosine : 0.0;
  turn.y = is_turned ? sine : 0.0;
  turn.z = is_turned ? 0.0 : sine;
  turn.w = is_turned ? 0.0 : cosine;
}

geometry_msgs::msg::TransformStamped transform_of(std::int64_t stamp_ns, const std::string& from,
                                                  const std::string& to,
                                                  const g4lidar::mounting& place) {
  geometry_msgs::msg::TransformStamped made;
  made.header.stamp = rclcpp::Time(stamp_ns);
  made.header.frame_id = from;
  made.child_frame_id = to;
  made.transform.translation.x = place.pose.x_m;
  made.transform.translation.y = place.pose.y_m;
  set(made.transform.rotation, place.pose.yaw_rad, place.upside_down);
  return made;
}

}  // namespace

robot_motion::robot_motion(rclcpp_lifecycle::LifecycleNode& node, const motion_options& options,
                           const std::string& frame_id, const std::string& source)
    : node_(node), options_(options) {
  if (g4lidar::kind_of_source(source) == g4lidar::source_kind::recording)
    recorded_ = odometry_in(source);
  if (!recorded_.empty()) {
    odometry_ = std::make_unique<counted_publisher<nav_msgs::msg::Odometry>>(
        node, "odom", rclcpp::QoS(5).reliable());
    tf_ = std::make_unique<tf2_ros::TransformBroadcaster>(node);
  }
  if (options.mount) {
    const bool is_down = options.mount->upside_down != options.is_turned;
    place_ = std::make_unique<tf2_ros::StaticTransformBroadcaster>(node);
    place_->sendTransform(
        transform_of(0, options.base_frame, frame_id, {options.mount->pose, is_down}));
  }
  if (options.from == motion_source::odometry && recorded_.empty()) {
    const auto take = [this](const nav_msgs::msg::Odometry& from) {
      const auto& [place, turn] = std::pair(from.pose.pose.position, from.pose.pose.orientation);
      const auto& [linear, angular] = std::pair(from.twist.twist.linear, from.twist.twist.angular);
      const auto made =
          g4lidar::planar_odometry(rclcpp::Time(from.header.stamp).nanoseconds(),
                                   {place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w},
                                   {linear.x, linear.y, linear.z, angular.x, angular.y, angular.z});
      const std::lock_guard lock(mutex_);
      if (made && subscribed_.size() < 1000) subscribed_.push_back(*made);
    };
    // Whoever publishes: with best effort every quality of service is accepted.
    subscription_ = node.create_subscription<nav_msgs::msg::Odometry>(
        "odom", rclcpp::QoS(100).best_effort(), take);
  }
  if (options.from == motion_source::tf) {
    buffer_ = std::make_unique<tf2_ros::Buffer>(node.get_clock());
    listener_ = std::make_unique<tf2_ros::TransformListener>(*buffer_);
  }
}

void robot_motion::follow(g4lidar::lidar& device) {
  player_ = device.player();
  begin_ns_ = player_ != nullptr ? player_->begin_ns() : 0;
  next_ = 0;
}

void robot_motion::follow(std::span<const g4lidar::point> points, std::int64_t ahead_ns) {
  if (recorded_.empty() || points.empty() || player_ == nullptr) return;
  // Points are a little older than their bytes, and rounds are further apart.
  constexpr std::int64_t largest_age_ns = 5'000'000;
  const std::int64_t begin_ns = player_->begin_ns();
  if (begin_ns != begin_ns_ && points.front().time_ns >= begin_ns - largest_age_ns) {
    const std::int64_t shift_ns = begin_ns - std::exchange(begin_ns_, begin_ns);
    for (g4lidar::stamped_odometry& each : recorded_) each.time_ns += shift_ns;
    next_ = 0;
  }
  if (next_ == 0) {  // what was before the first point is of no use, but for the last one
    const auto first = std::ranges::upper_bound(recorded_, points.front().time_ns, {},
                                                &g4lidar::stamped_odometry::time_ns);
    next_ =
        static_cast<std::size_t>(first - recorded_.begin()) - (first == recorded_.begin() ? 0 : 1);
  }
  while (next_ < recorded_.size() &&
         (next_ == 0 || recorded_[next_ - 1].time_ns < points.back().time_ns)) {
    publish(recorded_[next_++], ahead_ns);
  }
}

void robot_motion::publish(const g4lidar::stamped_odometry& at, std::int64_t ahead_ns) {
  path_.add(at);
  const std::int64_t stamp_ns = at.time_ns + ahead_ns;
  if (odometry_->is_wanted()) {
    auto made = std::make_unique<nav_msgs::msg::Odometry>();
    made->header.stamp = rclcpp::Time(stamp_ns);
    made->header.frame_id = options_.odometry_frame;
    made->child_frame_id = options_.base_frame;
    made->pose.pose.position.x = at.pose.x_m;
    made->pose.pose.position.y = at.pose.y_m;
    set(made->pose.pose.orientation, at.pose.yaw_rad, false);
    made->twist.twist.linear.x = at.twist.x_m_per_s;
    made->twist.twist.linear.y = at.twist.y_m_per_s;
    made->twist.twist.angular.z = at.twist.yaw_rad_per_s;
    odometry_->publish(std::move(made));
  }
  tf_->sendTransform(
      transform_of(stamp_ns, options_.odometry_frame, options_.base_frame, {at.pose, false}));
}

std::span<const g4lidar::stamped_pose> robot_motion::path_of(const g4lidar::scan& whole,
                                                             std::int64_t ahead_ns) {
  if (subscription_) take_subscribed(ahead_ns);
  if (buffer_) take_transforms(whole, ahead_ns);
  return path_.until(whole.end_ns());
}

void robot_motion::take_subscribed(std::int64_t ahead_ns) {
  const std::lock_guard lock(mutex_);
  for (g4lidar::stamped_odometry& each : subscribed_) {
    each.time_ns -= ahead_ns;
    path_.add(each);
  }
  subscribed_.clear();
}

void robot_motion::take_transforms(const g4lidar::scan& whole, std::int64_t ahead_ns) {
  const auto newest = path_.newest();
  std::int64_t time_ns = whole.time_ns() - tf_step_ns;
  if (newest) time_ns = std::max(time_ns, newest->time_ns + tf_step_ns);
  for (; time_ns < whole.end_ns() + tf_step_ns; time_ns += tf_step_ns) {
    const rclcpp::Time stamp(time_ns + ahead_ns, node_.get_clock()->get_clock_type());
    if (!buffer_->canTransform(options_.odometry_frame, options_.base_frame, stamp)) continue;
    const auto found =
        buffer_->lookupTransform(options_.odometry_frame, options_.base_frame, stamp);
    const auto& [x, y, z] = std::tuple(found.transform.translation.x, found.transform.translation.y,
                                       found.transform.translation.z);
    const auto& turn = found.transform.rotation;
    const auto made =
        g4lidar::planar_odometry(time_ns, {x, y, z, turn.x, turn.y, turn.z, turn.w}, {});
    if (!made) continue;
    g4lidar::stamped_odometry now = *made;
    if (const auto before = path_.newest(); before && before->time_ns < time_ns) {
      const double seconds = static_cast<double>(time_ns - before->time_ns) * 1e-9;
      now.twist = g4lidar::twist_to(inverse(before->pose) * now.pose, seconds);
    }
    path_.add(now);
  }
}

}  // namespace g4lidar_ros
