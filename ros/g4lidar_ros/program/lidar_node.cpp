// SPDX-License-Identifier: MIT
// The program lidar_node: one lidar. What is wrong with its parameters is one line, and exit code 1.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>

#include <rclcpp/rclcpp.hpp>

#include "g4lidar_ros/lidar_node.hpp"

int main(int argc, char* argv[]) {
  int code = EXIT_SUCCESS;
  bool is_begun = false;
  try {
    rclcpp::init(argc, argv);
    is_begun = true;
    const auto node = std::make_shared<g4lidar_ros::LidarNode>(rclcpp::NodeOptions());
    rclcpp::spin(node->get_node_base_interface());
  } catch (const std::exception& wrong) {
    if (is_begun && !rclcpp::ok()) return code;  // Ctrl-C before the node was made
    std::fprintf(stderr, "lidar_node: %s\n", wrong.what());
    code = EXIT_FAILURE;
  }
  if (rclcpp::ok()) rclcpp::shutdown();
  return code;
}
