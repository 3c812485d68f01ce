// SPDX-License-Identifier: MIT
#include "parameter_declarations.hpp"

#include <cstdint>
#include <string>

#include "g4lidar/core/model.hpp"
#include "g4lidar/lidar_parameters.hpp"

namespace g4lidar_ros {
namespace {

using descriptor = rcl_interfaces::msg::ParameterDescriptor;

/// Of a parameter that is set at the start only.
descriptor fixed(const std::string& description, const std::string& constraints = {}) {
  descriptor made;
  made.description = description;
  made.additional_constraints = constraints;
  made.read_only = true;
  return made;
}

descriptor fixed_number(const std::string& description, double least, double most) {
  descriptor made = fixed(description);
  made.floating_point_range.resize(1);
  made.floating_point_range[0].from_value = least;
  made.floating_point_range[0].to_value = most;
  return made;
}

descriptor fixed_count(const std::string& description, std::int64_t least, std::int64_t most) {
  descriptor made = fixed(description);
  made.integer_range.resize(1);
  made.integer_range[0].from_value = least;
  made.integer_range[0].to_value = most;
  made.integer_range[0].step = 1;
  return made;
}

/// The filters that keep everything.
rclcpp::ParameterValue first_value(const g4lidar::parameter& of) {
  if (of.kind == g4lidar::parameter_kind::device) return {};
  if (of.name == "range_min") return rclcpp::ParameterValue(0.0);
  if (of.name == "range_max") return rclcpp::ParameterValue(100.0);
  if (of.name == "fov") return rclcpp::ParameterValue("-180:180");
  if (of.name == "no_return") return rclcpp::ParameterValue("inf");
  if (of.name == "near_as") return rclcpp::ParameterValue("nan");
  return rclcpp::ParameterValue(
      of.kind == g4lidar::parameter_kind::filter && of.name != "ignore" ? "off" : "");
}

/// A parameter of the lidar. Its type is that of the table, but 10 is also taken for 10.0, and true for "on".
/// `model`: null if none is named, so that any may be found.
void declare(rclcpp_lifecycle::LifecycleNode& node, const g4lidar::parameter& row,
             const g4lidar::model* model) {
  const g4lidar::parameter of = model != nullptr ? g4lidar::limited_to(*model, row) : row;
  descriptor made;
  made.description = of.description;
  made.additional_constraints = of.constraints;
  made.dynamic_typing = true;
  if (of.kind == g4lidar::parameter_kind::read_only) made.additional_constraints = "read-only";
  if (const auto [least, most, step] = of.range; least < most) {
    made.floating_point_range.resize(1);
    made.floating_point_range[0].from_value = least;
    made.floating_point_range[0].to_value = most;
    made.floating_point_range[0].step = step;
  }
  node.declare_parameter(std::string(of.name), first_value(of), made);
}

}  // namespace

void declare_parameters(rclcpp_lifecycle::LifecycleNode& node) {
  node.declare_parameter("source", "",
                         fixed("The lidar or the recording",
                               "empty: the only lidar; /dev/ttyUSB0, serial:NUMBER, "
                               "usb:PATH, tcp:HOST:PORT, a file, or sim:"));
  node.declare_parameter(
      "model", "",
      fixed("The model of the lidar",
            "empty: the lidar is searched, or that of a recording; " + g4lidar::model_words()));
  node.declare_parameter("baud", 0,
                         fixed_count("Bits per second; 0: those of the model", 0, 10'000'000));
  node.declare_parameter("frame_id", "laser", fixed("Frame of the scans"));
  node.declare_parameter("grid", 0,
                         fixed_count("Ranges of each LaserScan; 0: those of the model", 0, 65536));
  node.declare_parameter("order", "angle",
                         fixed("Order of the ranges of a LaserScan", "angle, time"));
  node.declare_parameter("base_frame", "base_link", fixed("Frame of the robot"));
  node.declare_parameter("odometry_frame", "odom", fixed("Frame of the odometry"));
  node.declare_parameter("mount", "",
                         fixed("Where the lidar is on the robot, for /tf_static and deskewing",
                               "X,Y,DEG or X,Y,DEG,down, in metres and degrees; empty: unknown"));
  node.declare_parameter(
      "deskew", "none",
      fixed("Deskew each revolution by the scans alone, by the recorded or subscribed odometry, or "
            "by tf from odometry_frame to base_frame",
            "none, scans, odometry, tf"));
  node.declare_parameter("playback_speed", 1.0,
                         fixed_number("Speed of a recording; 1: as recorded", 0.01, 100.0));
  node.declare_parameter("loop", false, fixed("Start a recording again at its end"));
  node.declare_parameter(
      "connect_timeout", 10.0,
      fixed_number("How long configure waits for the lidar, s; 0: it succeeds without the lidar, "
                   "which is used when it comes",
                   0.0, 3600.0));
  node.declare_parameter("autostart", false,
                         fixed("Whether the node configures and activates itself at the start"));
  descriptor standby;
  standby.description = "Whether the motor rests while nobody subscribes to a scan or a cloud";
  node.declare_parameter("standby", false, standby);
  node.declare_parameter(
      "mask", "",
      fixed("File of polygons: returns inside of them, parts of the robot, are left out"));
  const g4lidar::model* const model = g4lidar::model_named(node.get_parameter("model").as_string());
  for (const g4lidar::parameter& each : g4lidar::all_parameters()) {
    if (!node.has_parameter(std::string(each.name))) declare(node, each, model);
  }
}

}  // namespace g4lidar_ros
