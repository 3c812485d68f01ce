// SPDX-License-Identifier: MIT
// The parameters of the node as ROS knows them: descriptions, limits, types, values at the start.
#pragma once

#include <string>

#include <rclcpp_lifecycle/lifecycle_node.hpp>

#include "g4lidar/options/option_table.hpp"

namespace g4lidar_ros {

/// Declares all but those of ROS itself. Throws what rclcpp throws, as for a value of the wrong type.
void declare_parameters(rclcpp_lifecycle::LifecycleNode& node);

/// Its name as a parameter.
[[nodiscard]] std::string node_name(const g4lidar::parameter& of);
/// The value without one that is given: the filters keep everything, and nothing is set.
[[nodiscard]] rclcpp::ParameterValue first_value(const g4lidar::parameter& of);
/// The value with this type, as g4lidar::converted(); of an array for a text "30:40 90:100"; as it is if that cannot be.
[[nodiscard]] rclcpp::ParameterValue converted(const rclcpp::ParameterValue& value,
                                               rclcpp::ParameterType to);
/// Nothing for arrays.
[[nodiscard]] g4lidar::parameter_value value_of(const rclcpp::ParameterValue& from);
/// A sector as a text.
[[nodiscard]] std::string sector_text(double from, double to);

/// What begins the names of the parameters that are the state of the lidar: "device.frequency".
inline constexpr std::string_view state_prefix = "device.";
/// Whether the lidar has a state of it: the settings and the serial number.
[[nodiscard]] bool has_state(const g4lidar::parameter& of);
/// The value of a setting or of a state. On and off are texts; nothing is 0 or empty: not wanted, or not known.
[[nodiscard]] rclcpp::ParameterValue shown(const g4lidar::parameter& parameter,
                                           const g4lidar::parameter_value& value);

}  // namespace g4lidar_ros
