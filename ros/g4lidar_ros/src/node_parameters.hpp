// SPDX-License-Identifier: MIT
// The parameters of the node.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

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

  /// The lidar whose parameters they are; null: none is open, and they are used when one is opened.
  void follow(std::shared_ptr<lidar_session> session);
  /// Takes over what has become known of the lidar.
  void update();

 private:
  using changes = std::vector<rclcpp::Parameter>;
  void warn_about_unknown_ones() const;
  void take_motion(session_options& into) const;
  /// The filters now.
  [[nodiscard]] std::vector<g4lidar::named_value> filters() const;
  /// Why these cannot be set, or empty: what is wrong with them, or that there is no lidar for a setting.
  [[nodiscard]] std::string refuse_while_searching(
      const std::vector<g4lidar::named_value>& wanted) const;
  [[nodiscard]] std::string refuse(const changes& wanted);

  rclcpp_lifecycle::LifecycleNode& node_;
  std::shared_ptr<lidar_session> session_;
  bool is_update_ = false;  // they are set by update()
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr refusing_;
};

}  // namespace g4lidar_ros
