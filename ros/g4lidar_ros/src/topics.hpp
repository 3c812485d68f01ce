// SPDX-License-Identifier: MIT
// The topics of a lidar, and its scans and clouds as messages of ROS.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <memory>
#include <string>

#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <rclcpp_lifecycle/lifecycle_publisher.hpp>
#include <rosgraph_msgs/msg/clock.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>

#include "g4lidar/grid.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/scan.hpp"

namespace g4lidar_ros {

/// What became of the messages of a topic.
struct topic_counts {
  std::atomic<std::uint64_t> sent = 0;
  std::atomic<std::uint64_t> refused = 0;  ///< Subscribers that want another quality of service.
};

/// A lifecycle publisher with its counts. A message that nobody reads is not made. *Any thread.*
template <class Message>
class counted_publisher {
 public:
  counted_publisher(rclcpp_lifecycle::LifecycleNode& node, const std::string& topic,
                    const rclcpp::QoS& quality) {
    rclcpp::PublisherOptions options;
    options.qos_overriding_options = rclcpp::QosOverridingOptions::with_default_policies();
    options.event_callbacks.incompatible_qos_callback =
        [counts = counts_, name = topic,
         logger = node.get_logger()](rclcpp::QOSOfferedIncompatibleQoSInfo& info) {
          counts->refused = static_cast<std::uint64_t>(info.total_count);
          RCLCPP_WARN(logger, "%s: a subscriber wants a quality of service that is not offered",
                      name.c_str());
        };
    try {
      publisher_ = node.create_publisher<Message>(topic, quality, options);
    } catch (const rclcpp::UnsupportedEventTypeException&) {  // of this middleware
      options.event_callbacks = {};
      publisher_ = node.create_publisher<Message>(topic, quality, options);
    }
  }

  [[nodiscard]] bool is_wanted() const { return publisher_->is_activated() && subscribers() > 0; }
  [[nodiscard]] std::size_t subscribers() const { return publisher_->get_subscription_count(); }
  /// Within a process it is given to subscribers without a copy.
  void publish(std::unique_ptr<Message> message) {
    publisher_->publish(std::move(message));
    ++counts_->sent;
  }
  [[nodiscard]] const topic_counts& counts() const noexcept { return *counts_; }
  [[nodiscard]] const char* name() const { return publisher_->get_topic_name(); }

 private:
  std::shared_ptr<topic_counts> counts_ = std::make_shared<topic_counts>();
  typename rclcpp_lifecycle::LifecyclePublisher<Message>::SharedPtr publisher_;
};

/// Makes a call that publishes. What it throws is an error in the log.
template <class Call>
void guard(const rclcpp_lifecycle::LifecycleNode& node, Call call) noexcept {
  try {
    call();
  } catch (const std::exception& failure) {
    RCLCPP_ERROR_THROTTLE(node.get_logger(), *node.get_clock(), 5000, "%s", failure.what());
  }
}

/// The topics of a lidar. A node keeps memory of each lifecycle publisher that it ever had, so they are made once.
struct lidar_topics {
  explicit lidar_topics(rclcpp_lifecycle::LifecycleNode& node);

  counted_publisher<sensor_msgs::msg::LaserScan> scans;
  counted_publisher<sensor_msgs::msg::PointCloud2> clouds;
  /// Null until a source with odometry.
  std::unique_ptr<counted_publisher<nav_msgs::msg::Odometry>> odometry;
  /// Null until a recording.
  std::unique_ptr<counted_publisher<rosgraph_msgs::msg::Clock>> clock;
};

/// A revolution as put_laser_scan() writes it, with `bins` ranges; `header.duration_ns` is that of the revolution.
[[nodiscard]] std::unique_ptr<sensor_msgs::msg::LaserScan> laser_scan_of(
    const g4lidar::scan& for_grid, g4lidar::message_header header,
    const g4lidar::grid_options& grid, std::size_t bins);
/// Its returns as put_point_cloud2() writes them.
[[nodiscard]] std::unique_ptr<sensor_msgs::msg::PointCloud2> cloud_of(
    const g4lidar::scan& kept, const g4lidar::message_header& header);

}  // namespace g4lidar_ros
