// SPDX-License-Identifier: MIT
// The parameters of the node as ROS knows them: descriptions, limits, values at the start.
#pragma once

#include <rclcpp_lifecycle/lifecycle_node.hpp>

namespace g4lidar_ros {

/// Declares all but those of ROS itself. Throws what rclcpp throws, as for a value of the wrong type.
void declare_parameters(rclcpp_lifecycle::LifecycleNode& node);

}  // namespace g4lidar_ros
