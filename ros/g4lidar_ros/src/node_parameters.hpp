// SPDX-License-Identifier: MIT
// The parameters of the node.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <rclcpp/version.h>
#include <rclcpp_lifecycle/lifecycle_node.hpp>

#include "lidar_session.hpp"

namespace g4lidar_ros {

/// Declares them, with descriptions and limits. They are what the user wants; only the states, such as device.frequency,
/// are what the lidar has. *Single thread*: that of the node.
class node_parameters {
 public:
  explicit node_parameters(rclcpp_lifecycle::LifecycleNode& node);

  /// Those that are used when lidars are opened. Throws std::invalid_argument, which names the parameter.
  [[nodiscard]] session_options for_session() const;
  /// The lidar whose parameters they are; null: none is open, and they are used when one is opened.
  void follow(std::shared_ptr<lidar_session> session);
  /// Takes over what has become known of the lidar, into the states.
  void update(bool is_news = false);

 private:
  using changes = std::vector<rclcpp::Parameter>;
  void warn_about_unknown_ones() const;
  void take_motion(session_options& into) const;
  /// How a lidar is opened.
  void take_opening(g4lidar::lidar_options& into) const;
  /// Those of `source` or `sources`.
  [[nodiscard]] std::vector<g4lidar::service_lidar> lidars() const;
  [[nodiscard]] std::string text(const std::string& parameter) const {
    return node_.get_parameter(parameter).as_string();
  }
  /// How long the lidar may be missing.
  [[nodiscard]] std::chrono::milliseconds connect_timeout() const;
  /// Each gets the type of its parameter, if it can be converted.
  void convert(changes& wanted) const;
  /// The filters after these changes. Throws std::invalid_argument if two fields of view are given.
  [[nodiscard]] std::vector<g4lidar::named_value> filters(const changes& wanted) const;
  /// Why these cannot be set, or empty. Throws std::invalid_argument, too.
  [[nodiscard]] std::string refuse(const changes& wanted);

  rclcpp_lifecycle::LifecycleNode& node_;
  std::shared_ptr<lidar_session> session_;
  bool is_update_ = false;  // the states are set
#if RCLCPP_VERSION_GTE(21, 0, 0)
  rclcpp::node_interfaces::PreSetParametersCallbackHandle::SharedPtr converting_;
#endif
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr refusing_;
};

}  // namespace g4lidar_ros
