// SPDX-License-Identifier: MIT
// A lidar as a lifecycle node and component of ROS 2.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_srvs/srv/trigger.hpp>

#include <g4lidar/standby.hpp>

namespace g4lidar_ros {

class lidar_session;
class node_diagnostics;
class node_parameters;
struct lidar_topics;

/// configure opens the lidar, activate turns its motor and publishes, deactivate rests it, cleanup closes it. An unplug
/// is a warning, after which it reconnects. An error that it cannot recover from deactivates it, and on_deactivate()
/// returns ERROR. on_configure() returns FAILURE if there is no lidar, which may come later, else ERROR. A thread of its
/// own reads the lidar; everything else is in the default callback group.
// Components of ROS are named so.
class LidarNode : public rclcpp_lifecycle::LifecycleNode {  // NOLINT(readability-identifier-naming)
 public:
  // NOLINTNEXTLINE(readability-identifier-naming): the name of ROS
  using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;

  explicit LidarNode(const rclcpp::NodeOptions& options);
  /// Rests the motor and closes the lidar.
  ~LidarNode() override;

  CallbackReturn on_configure(const rclcpp_lifecycle::State& previous) override;
  CallbackReturn on_activate(const rclcpp_lifecycle::State& previous) override;
  CallbackReturn on_deactivate(const rclcpp_lifecycle::State& previous) override;
  CallbackReturn on_cleanup(const rclcpp_lifecycle::State& previous) override;
  CallbackReturn on_shutdown(const rclcpp_lifecycle::State& previous) override;
  CallbackReturn on_error(const rclcpp_lifecycle::State& previous) override;

 private:
  using trigger = std_srvs::srv::Trigger;

  /// Makes the session that opens the lidar, if there is none. Throws if a parameter is wrong.
  void open();
  /// Whether the lidar is being opened; begins it.
  bool is_opening();
  /// Configures and activates itself, when the lidar is open.
  void start_itself();
  /// Rests or turns the motor, and notices the end of the lidar. Called several times a second.
  void update();
  void allow(bool runs, trigger::Response& answer);

  std::unique_ptr<node_parameters> parameters_;
  std::unique_ptr<lidar_topics> topics_;    // since the first configure
  std::shared_ptr<lidar_session> session_;  // null unless it is configured, or starts itself
  std::unique_ptr<node_diagnostics> diagnostics_;
  std::vector<rclcpp::ServiceBase::SharedPtr> services_;
  rclcpp::SubscriptionBase::SharedPtr running_;
  rclcpp::TimerBase::SharedPtr timer_;
  g4lidar::standby standby_;
  bool is_allowed_ = true;  // by ~/start, ~/stop and ~/run
  bool starts_itself_ = false;
  /// When a lidar that is missing is reported as an error.
  std::optional<std::chrono::steady_clock::time_point> late_at_;
};

}  // namespace g4lidar_ros
