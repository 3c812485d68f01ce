// SPDX-License-Identifier: MIT
// The motion of the robot: from a recording or a simulated robot, which is published; from odometry, or from tf.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tf2_ros/buffer.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>
#include <tf2_ros/transform_listener.h>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>

#include "g4lidar/lidar.hpp"
#include "g4lidar/odometry_feed.hpp"
#include "g4lidar/odometry_path.hpp"
#include "topics.hpp"

namespace g4lidar_ros {

/// The stamp of a time that `ahead_ns` are added to: a stamp of ROS is not negative.
[[nodiscard]] inline std::int64_t stamp_of(std::int64_t time_ns, std::int64_t ahead_ns) noexcept {
  return std::max<std::int64_t>(0, time_ns + ahead_ns);
}

/// From where the motion is known by which points are deskewed, in the order of the words of the parameter deskew.
enum class motion_source : unsigned char { none, odometry, scans, tf };

struct motion_options {
  motion_source from = motion_source::none;
  std::string base_frame = "base_link";
  std::string odometry_frame = "odom";
  std::optional<g4lidar::mounting> mount;  ///< Published on /tf_static.
  bool is_turned = false;                  ///< The frame of the scans has z down.
};

/// *Single thread*: that of the reader, except construction.
class robot_motion {
 public:
  /// Of a lidar whose frame is `frame_id`, and whose source is `source`; adds the topic of its odometry.
  robot_motion(rclcpp_lifecycle::LifecycleNode& node, lidar_topics& topics,
               const motion_options& options, const std::string& frame_id,
               const std::string& source);

  /// Whether the source carries odometry, which needs its points as they come.
  [[nodiscard]] bool has_odometry() const noexcept { return has_odometry_; }
  /// The lidar is open. `simulation`: null unless it is simulated.
  void follow(g4lidar::lidar& device, const g4lidar::sim::simulated_source* simulation);
  /// Publishes the odometry until the last of these points. `ahead_ns`: the time of stamps minus theirs; nothing: not
  /// known, and stamps are 0.
  void follow(std::span<const g4lidar::point> points, std::optional<std::int64_t> ahead_ns);
  /// The poses of the robot until the end of a scan, by the clock of its points.
  [[nodiscard]] std::span<const g4lidar::stamped_pose> path_of(
      const g4lidar::scan& whole, std::optional<std::int64_t> ahead_ns);

 private:
  void publish(const g4lidar::stamped_odometry& at, std::int64_t stamp_ns);
  void take_subscribed(std::int64_t ahead_ns);
  void take_transforms(const g4lidar::scan& whole, std::int64_t ahead_ns);

  rclcpp_lifecycle::LifecycleNode& node_;
  lidar_topics& topics_;
  motion_options options_;
  g4lidar::odometry_feed feed_;
  bool has_odometry_ = false;
  g4lidar::odometry_path path_;
  std::unique_ptr<tf2_ros::TransformBroadcaster> tf_;
  std::unique_ptr<tf2_ros::StaticTransformBroadcaster> place_;
  std::mutex mutex_;                                   // protects the next one
  std::vector<g4lidar::stamped_odometry> subscribed_;  // by the clock of the stamps
  std::int64_t taken_ns_ = 0;                          // the last stamp that was taken of them
  rclcpp::SubscriptionBase::SharedPtr subscription_;
  std::unique_ptr<tf2_ros::Buffer> buffer_;
  std::unique_ptr<tf2_ros::TransformListener> listener_;
};

}  // namespace g4lidar_ros
