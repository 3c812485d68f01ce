// SPDX-License-Identifier: MIT
// The motion of the robot: that of the source is published; that of others is subscribed, as odometry or by tf.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <tf2_ros/buffer.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>
#include <tf2_ros/transform_listener.h>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>

#include "g4lidar/lidar_service.hpp"
#include "topics.hpp"

namespace g4lidar_ros {

/// From where the motion is known by which points are deskewed, in the order of the words of the parameter deskew.
enum class motion_source : unsigned char { none, odometry, scans, tf };

struct motion_options {
  motion_source from = motion_source::none;
  std::string base_frame = "base_link";
  std::string odometry_frame = "odom";
  std::optional<g4lidar::mounting> mount;  ///< Published on /tf_static.
  bool is_turned = false;                  ///< The frame of the scans has z down.
};

/// As a sink, publishes the odometry and the time that the source states. In the thread of a lidar, but for the first two.
class odometry_publisher final : public g4lidar::service_sink {
 public:
  odometry_publisher(rclcpp_lifecycle::LifecycleNode& node, lidar_topics& topics,
                     const motion_options& options)
      : node_(node), topics_(topics), options_(options) {}
  /// Makes what it needs of ROS, for scans whose frame is `frame_id`. `has_odometry`: the source states the motion.
  void connect(const std::string& frame_id, bool has_odometry);

  [[nodiscard]] g4lidar::service_demand wanted() const override { return {}; }
  void on_odometry(const g4lidar::stamped_odometry& now, std::int64_t stamp_ns) override;
  void on_time(std::size_t lidar, std::int64_t stamp_ns) override;
  /// Adds what others state, until the end of a scan. `ahead_ns`: the clock of stamps minus that of the points.
  void take(g4lidar::odometry_path& into, const g4lidar::scan& whole, std::int64_t ahead_ns);

 private:
  void publish(const g4lidar::stamped_odometry& odometry, std::int64_t stamp_ns);
  void subscribe();
  void take_subscribed(g4lidar::odometry_path& into, std::int64_t ahead_ns);
  void take_transforms(g4lidar::odometry_path& into, const g4lidar::scan& whole,
                       std::int64_t ahead_ns);

  rclcpp_lifecycle::LifecycleNode& node_;
  lidar_topics& topics_;
  const motion_options options_;
  std::int64_t clock_ns_ = 0;  // as published
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
