// SPDX-License-Identifier: MIT
// The parameters of the node.
#pragma once

#include <chrono>
#include <string>

#include <rclcpp_lifecycle/lifecycle_node.hpp>

#include "lidar_session.hpp"

namespace g4lidar_ros {

/// Declares them, with descriptions and limits. *Single thread*: that of the node.
class node_parameters {
 public:
  explicit node_parameters(rclcpp_lifecycle::LifecycleNode& node);

  /// Those that are used when the lidar is opened. Throws std::invalid_argument, which names the parameter.
  [[nodiscard]] session_options for_session() const;
  /// How long configure waits for the lidar; 0: it does not.
  [[nodiscard]] std::chrono::nanoseconds connect_timeout() const;
  [[nodiscard]] bool starts_itself() const;
  [[nodiscard]] bool is_standby() const;

 private:
  rclcpp_lifecycle::LifecycleNode& node_;
};

}  // namespace g4lidar_ros
