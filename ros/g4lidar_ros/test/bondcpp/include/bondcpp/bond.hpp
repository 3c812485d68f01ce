// SPDX-License-Identifier: MIT
// Stands for bond::Bond of bondcpp, for the tests: the functions that the node calls. The message is a text, "ID alive"
// or "ID dead", instead of bond/msg/Status.
#pragma once

#include <chrono>
#include <string>

#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <std_msgs/msg/string.hpp>

namespace bond {

class Bond {  // NOLINT(readability-identifier-naming): the names of bondcpp
 public:
  Bond(const std::string& topic, std::string id,
       const rclcpp_lifecycle::LifecycleNode::SharedPtr& node)
      : id_(std::move(id)),
        node_(*node),
        publisher_(rclcpp::create_publisher<std_msgs::msg::String>(node, topic, rclcpp::QoS(10))) {}
  ~Bond() { publish("dead"); }
  Bond(const Bond&) = delete;
  Bond& operator=(const Bond&) = delete;

  void setHeartbeatPeriod(double seconds) { period_ = std::chrono::duration<double>(seconds); }
  void setHeartbeatTimeout(double /*seconds*/) {}
  void start() {
    timer_ = node_.create_wall_timer(period_, [this] { publish("alive"); });
  }

 private:
  void publish(const char* state) {
    std_msgs::msg::String made;
    made.data = id_ + " " + state;
    publisher_->publish(made);
  }

  std::string id_;
  rclcpp_lifecycle::LifecycleNode& node_;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr publisher_;
  rclcpp::TimerBase::SharedPtr timer_;
  std::chrono::duration<double> period_{1.0};
};

}  // namespace bond
