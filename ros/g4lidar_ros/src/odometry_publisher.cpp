// SPDX-License-Identifier: MIT
#include "odometry_publisher.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <tuple>
#include <utility>

#include <geometry_msgs/msg/transform_stamped.hpp>

namespace g4lidar_ros {
namespace {

/// Poses are looked up in tf so far apart.
constexpr std::int64_t tf_step_ns = 20'000'000;
/// The messages on /clock are at most so far apart, or a simulation is too slow for its motion.
constexpr std::int64_t largest_clock_step_ns = 100'000'000;

void set(geometry_msgs::msg::Quaternion& turn, const g4lidar::mounting& place) {
  const auto [x, y, z, w] = g4lidar::quaternion_of(place);
  turn.x = x;
  turn.y = y;
  turn.z = z;
  turn.w = w;
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
  set(made.transform.rotation, place);
  return made;
}

}  // namespace

void odometry_publisher::connect(const std::string& frame_id, bool has_odometry) {
  if (has_odometry) {
    if (!topics_.odometry)
      topics_.odometry = std::make_unique<counted_publisher<nav_msgs::msg::Odometry>>(
          node_, "odom", rclcpp::QoS(5).reliable());
    tf_ = std::make_unique<tf2_ros::TransformBroadcaster>(node_);
  }
  if (options_.mount) {
    const bool is_down = options_.mount->upside_down != options_.is_turned;
    // Within a process, Jazzy keeps nothing for the late subscribers of other processes.
    rclcpp::PublisherOptions how;
    how.use_intra_process_comm = rclcpp::IntraProcessSetting::Disable;
    place_ = std::make_unique<tf2_ros::StaticTransformBroadcaster>(
        node_, tf2_ros::StaticBroadcasterQoS(), how);
    place_->sendTransform(
        transform_of(0, options_.base_frame, frame_id, {options_.mount->pose, is_down}));
  }
  if (has_odometry) return;
  if (options_.from == motion_source::odometry) subscribe();
  if (options_.from == motion_source::tf) {
    buffer_ = std::make_unique<tf2_ros::Buffer>(node_.get_clock());
    // Subscriptions of this node, so that its remappings are used, in a thread of their own. Those of Humble cannot be
    // transient local within a process.
    auto fixed = tf2_ros::detail::get_default_transform_listener_static_sub_options();
    fixed.use_intra_process_comm = rclcpp::IntraProcessSetting::Disable;
    listener_ = std::make_unique<tf2_ros::TransformListener>(
        *buffer_, &node_, true, tf2_ros::DynamicListenerQoS(), tf2_ros::StaticListenerQoS(),
        tf2_ros::detail::get_default_transform_listener_sub_options(), fixed);
  }
}

void odometry_publisher::subscribe() {
  const auto take = [this](const nav_msgs::msg::Odometry& from) {
    const auto& [place, turn] = std::pair(from.pose.pose.position, from.pose.pose.orientation);
    const auto& [linear, angular] = std::pair(from.twist.twist.linear, from.twist.twist.angular);
    const auto made =
        g4lidar::planar_odometry(rclcpp::Time(from.header.stamp).nanoseconds(),
                                 {place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w},
                                 {linear.x, linear.y, linear.z, angular.x, angular.y, angular.z});
    const std::lock_guard lock(mutex_);
    if (!made) return;
    if (subscribed_.size() == 1000)
      subscribed_.erase(subscribed_.begin());  // while the motor rests
    subscribed_.push_back(*made);
  };
  rclcpp::SubscriptionOptions how;
  how.qos_overriding_options = rclcpp::QosOverridingOptions::with_default_policies();
  // With best effort every quality of service of a publisher is accepted.
  subscription_ = node_.create_subscription<nav_msgs::msg::Odometry>(
      "odom", rclcpp::QoS(100).best_effort(), take, how);
}

void odometry_publisher::on_odometry(const g4lidar::stamped_odometry& now, std::int64_t stamp_ns) {
  guard(node_, [&] { publish(now, stamp_ns); });
}

void odometry_publisher::on_time(std::size_t /*lidar*/, std::int64_t stamp_ns) {
  constexpr std::int64_t clock_step_ns = 10'000'000;
  guard(node_, [&] {
    if (!topics_.clock || !topics_.clock->is_wanted() ||
        std::abs(stamp_ns - clock_ns_) < clock_step_ns)
      return;
    clock_ns_ = stamp_ns;
    auto made = std::make_unique<rosgraph_msgs::msg::Clock>();
    made->clock = rclcpp::Time(stamp_ns);
    topics_.clock->publish(std::move(made));
  });
}

void odometry_publisher::publish(const g4lidar::stamped_odometry& odometry, std::int64_t stamp_ns) {
  if (topics_.odometry->is_wanted()) {
    auto made = std::make_unique<nav_msgs::msg::Odometry>();
    made->header.stamp = rclcpp::Time(stamp_ns);
    made->header.frame_id = options_.odometry_frame;
    made->child_frame_id = options_.base_frame;
    made->pose.pose.position.x = odometry.pose.x_m;
    made->pose.pose.position.y = odometry.pose.y_m;
    set(made->pose.pose.orientation, {odometry.pose, false});
    made->twist.twist.linear.x = odometry.twist.x_m_per_s;
    made->twist.twist.linear.y = odometry.twist.y_m_per_s;
    made->twist.twist.angular.z = odometry.twist.yaw_rad_per_s;
    topics_.odometry->publish(std::move(made));
  }
  tf_->sendTransform(
      transform_of(stamp_ns, options_.odometry_frame, options_.base_frame, {odometry.pose, false}));
}

void odometry_publisher::take(g4lidar::odometry_path& into, const g4lidar::scan& whole,
                              std::int64_t ahead_ns) {
  guard(node_, [&] {
    if (subscription_) take_subscribed(into, ahead_ns);
    if (buffer_) take_transforms(into, whole, ahead_ns);
  });
}

void odometry_publisher::take_subscribed(g4lidar::odometry_path& into, std::int64_t ahead_ns) {
  const std::lock_guard lock(mutex_);
  for (g4lidar::stamped_odometry each : subscribed_) {
    const bool is_later = each.time_ns > std::exchange(taken_ns_, each.time_ns);
    each.time_ns -= ahead_ns;
    const auto newest = into.newest();
    // The time of /clock goes in steps, and with it the offset: this is no way back of the robot.
    const bool is_by_step = is_later && newest && each.time_ns <= newest->time_ns &&
                            each.time_ns > newest->time_ns - largest_clock_step_ns;
    if (!is_by_step) into.add(each);
  }
  subscribed_.clear();
}

void odometry_publisher::take_transforms(g4lidar::odometry_path& into, const g4lidar::scan& whole,
                                         std::int64_t ahead_ns) {
  const auto newest = into.newest();
  std::int64_t time_ns = whole.time_ns() - tf_step_ns;
  if (newest) time_ns = std::max(time_ns, newest->time_ns + tf_step_ns);
  for (; time_ns < whole.end_ns() + tf_step_ns; time_ns += tf_step_ns) {
    if (time_ns + ahead_ns <= 0)
      continue;  // before the first stamp; 0 would be the newest transform
    const tf2::TimePoint stamp{std::chrono::nanoseconds(time_ns + ahead_ns)};
    std::string why;  // without it, each failure is printed
    if (!buffer_->BufferCore::canTransform(options_.odometry_frame, options_.base_frame, stamp,
                                           &why))
      continue;
    const auto found =
        buffer_->BufferCore::lookupTransform(options_.odometry_frame, options_.base_frame, stamp);
    const auto& [x, y, z] = std::tuple(found.transform.translation.x, found.transform.translation.y,
                                       found.transform.translation.z);
    const auto& turn = found.transform.rotation;
    const auto made =
        g4lidar::planar_odometry(time_ns, {x, y, z, turn.x, turn.y, turn.z, turn.w}, {});
    if (!made) continue;
    g4lidar::stamped_odometry now = *made;
    if (const auto before = into.newest(); before && before->time_ns < time_ns) {
      const double seconds = static_cast<double>(time_ns - before->time_ns) * 1e-9;
      now.twist = g4lidar::twist_to(inverse(before->pose) * now.pose, seconds);
    }
    into.add(now);
  }
}

}  // namespace g4lidar_ros
