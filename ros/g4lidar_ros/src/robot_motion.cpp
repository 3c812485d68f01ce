// SPDX-License-Identifier: MIT
#include "robot_motion.hpp"

#include <algorithm>
#include <chrono>
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

robot_motion::robot_motion(rclcpp_lifecycle::LifecycleNode& node, lidar_topics& topics,
                           const motion_options& options, const std::string& frame_id,
                           const std::string& source)
    : node_(node), topics_(topics), options_(options) {
  // What cannot be read is reported when the source is opened as a lidar.
  if (g4lidar::kind_of_source(source) == g4lidar::source_kind::recording)
    static_cast<void>(feed_.load_recording(
        g4lidar::path_of_source(source),
        [of = node.get_node_base_interface()->get_context()] { return !of->is_valid(); }));
  has_odometry_ = feed_.is_known() || g4lidar::has_simulated_robot(source);
  if (has_odometry_) {
    if (!topics.odometry)
      topics.odometry = std::make_unique<counted_publisher<nav_msgs::msg::Odometry>>(
          node, "odom", rclcpp::QoS(5).reliable());
    tf_ = std::make_unique<tf2_ros::TransformBroadcaster>(node);
  }
  if (options.mount) {
    const bool is_down = options.mount->upside_down != options.is_turned;
    // Within a process, Jazzy keeps nothing for the late subscribers of other processes.
    rclcpp::PublisherOptions options_of_place;
    options_of_place.use_intra_process_comm = rclcpp::IntraProcessSetting::Disable;
    place_ = std::make_unique<tf2_ros::StaticTransformBroadcaster>(
        node, tf2_ros::StaticBroadcasterQoS(), options_of_place);
    place_->sendTransform(
        transform_of(0, options.base_frame, frame_id, {options.mount->pose, is_down}));
  }
  if (options.from == motion_source::odometry && !has_odometry_) {
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
    subscription_ = node.create_subscription<nav_msgs::msg::Odometry>(
        "odom", rclcpp::QoS(100).best_effort(), take, how);
  }
  if (options.from == motion_source::tf) {
    buffer_ = std::make_unique<tf2_ros::Buffer>(node.get_clock());
    // Subscriptions of this node, so that its remappings are used, in a thread of their own. Those of Humble cannot be
    // transient local within a process.
    auto fixed = tf2_ros::detail::get_default_transform_listener_static_sub_options();
    fixed.use_intra_process_comm = rclcpp::IntraProcessSetting::Disable;
    listener_ = std::make_unique<tf2_ros::TransformListener>(
        *buffer_, &node, true, tf2_ros::DynamicListenerQoS(), tf2_ros::StaticListenerQoS(),
        tf2_ros::detail::get_default_transform_listener_sub_options(), fixed);
  }
}

void robot_motion::follow(g4lidar::lidar& device,
                          const g4lidar::sim::simulated_source* simulation) {
  if (g4lidar::player* const played = device.player())
    feed_.follow(*played);
  else
    feed_.follow(simulation);
}

void robot_motion::follow(std::span<const g4lidar::point> points,
                          std::optional<std::int64_t> ahead_ns) {
  feed_.follow(points, [&](const g4lidar::stamped_odometry& at) {
    publish(at, ahead_ns ? stamp_of(at.time_ns, *ahead_ns) : 0);
  });
}

void robot_motion::publish(const g4lidar::stamped_odometry& at, std::int64_t stamp_ns) {
  path_.add(at);
  if (topics_.odometry->is_wanted()) {
    auto made = std::make_unique<nav_msgs::msg::Odometry>();
    made->header.stamp = rclcpp::Time(stamp_ns);
    made->header.frame_id = options_.odometry_frame;
    made->child_frame_id = options_.base_frame;
    made->pose.pose.position.x = at.pose.x_m;
    made->pose.pose.position.y = at.pose.y_m;
    set(made->pose.pose.orientation, {at.pose, false});
    made->twist.twist.linear.x = at.twist.x_m_per_s;
    made->twist.twist.linear.y = at.twist.y_m_per_s;
    made->twist.twist.angular.z = at.twist.yaw_rad_per_s;
    topics_.odometry->publish(std::move(made));
  }
  tf_->sendTransform(
      transform_of(stamp_ns, options_.odometry_frame, options_.base_frame, {at.pose, false}));
}

std::span<const g4lidar::stamped_pose> robot_motion::path_of(const g4lidar::scan& whole,
                                                             std::optional<std::int64_t> ahead_ns) {
  if (subscription_ && ahead_ns) take_subscribed(*ahead_ns);
  if (buffer_ && ahead_ns) take_transforms(whole, *ahead_ns);
  return path_.until(whole.end_ns());
}

void robot_motion::take_subscribed(std::int64_t ahead_ns) {
  const std::lock_guard lock(mutex_);
  for (g4lidar::stamped_odometry each : subscribed_) {
    const bool is_later = each.time_ns > std::exchange(taken_ns_, each.time_ns);
    each.time_ns -= ahead_ns;
    const auto newest = path_.newest();
    // The time of /clock goes in steps, and with it the offset: this is no way back of the robot.
    const bool is_by_step = is_later && newest && each.time_ns <= newest->time_ns &&
                            each.time_ns > newest->time_ns - largest_clock_step_ns;
    if (!is_by_step) path_.add(each);
  }
  subscribed_.clear();
}

void robot_motion::take_transforms(const g4lidar::scan& whole, std::int64_t ahead_ns) {
  const auto newest = path_.newest();
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
    if (const auto before = path_.newest(); before && before->time_ns < time_ns) {
      const double seconds = static_cast<double>(time_ns - before->time_ns) * 1e-9;
      now.twist = g4lidar::twist_to(inverse(before->pose) * now.pose, seconds);
    }
    path_.add(now);
  }
}

}  // namespace g4lidar_ros
