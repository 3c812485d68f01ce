// SPDX-License-Identifier: MIT
// A lidar, or several merged ones, as a lifecycle node and component of ROS 2.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_srvs/srv/trigger.hpp>

namespace g4lidar_ros {

class lidar_session;
class node_diagnostics;
class node_parameters;
struct lidar_topics;

/// configure begins to open the lidar, activate turns its motor and publishes, deactivate rests it, cleanup closes it. A
/// thread of its own opens and reads the lidar, so configure does not wait for one, which may come later; everything else
/// is in the default callback group. An unplug is a warning, after which it reconnects. After an error that it cannot
/// recover from it is unconfigured: on_configure(), on_activate() or on_deactivate() returns ERROR.
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

  /// Starts itself, and notices the end of the lidar. Called several times a second.
  void update();
  void allow(bool runs, trigger::Response& answer);
  /// `cause`: who wants it, for the log.
  void allow(bool runs, const std::string& cause);

  std::unique_ptr<lidar_topics> topics_;    // since the first configure; outlives the next ones
  std::shared_ptr<lidar_session> session_;  // null unless it is configured
  std::unique_ptr<node_parameters> parameters_;
  std::unique_ptr<node_diagnostics> diagnostics_;
  std::vector<rclcpp::ServiceBase::SharedPtr> services_;
  rclcpp::SubscriptionBase::SharedPtr running_;
  rclcpp::TimerBase::SharedPtr timer_;
  std::shared_ptr<void> bond_;  // with a lifecycle manager; null: none
  bool starts_itself_ = false;
};

}  // namespace g4lidar_ros
