// SPDX-License-Identifier: MIT
#include "node_parameters.hpp"

#include <stdexcept>

#include "g4lidar/core/model.hpp"

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

}  // namespace

node_parameters::node_parameters(rclcpp_lifecycle::LifecycleNode& node) : node_(node) {
  node.declare_parameter("source", "",
                         fixed("The lidar or the recording",
                               "empty: the only lidar; /dev/ttyUSB0, serial:NUMBER, "
                               "usb:PATH, tcp:HOST:PORT, a file, or sim:"));
  node.declare_parameter("model", "",
                         fixed("The model of the lidar",
                               "empty: a G4, or that of a recording; " + g4lidar::model_words()));
  node.declare_parameter("baud", 0,
                         fixed_count("Bits per second; 0: those of the model", 0, 10'000'000));
  node.declare_parameter("frame_id", "laser", fixed("Frame of the scans"));
  node.declare_parameter("grid", 0,
                         fixed_count("Ranges of each LaserScan; 0: those of the model", 0, 65536));
  node.declare_parameter("order", "angle",
                         fixed("Order of the ranges of a LaserScan", "angle, time"));
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
}

session_options node_parameters::for_session() const {
  session_options made;
  g4lidar::lidar_options& lidar = made.lidar;
  lidar.device = node_.get_parameter("source").as_string();
  if (const std::string word = node_.get_parameter("model").as_string(); !word.empty()) {
    lidar.model = g4lidar::model_named(word);
    if (lidar.model == nullptr)
      throw std::invalid_argument("model: '" + word + "' is not one of " + g4lidar::model_words());
    lidar.baud = lidar.model->bauds[0];
  }
  if (const auto baud = node_.get_parameter("baud").as_int(); baud > 0)
    lidar.baud = static_cast<std::uint32_t>(baud);
  lidar.reconnect = true;
  lidar.device_wait = std::chrono::milliseconds::max();
  lidar.playback.speed = node_.get_parameter("playback_speed").as_double();
  lidar.playback.loop = node_.get_parameter("loop").as_bool();
  made.frame_id = node_.get_parameter("frame_id").as_string();
  if (const auto bins = node_.get_parameter("grid").as_int(); bins > 0)
    made.bins = static_cast<std::uint32_t>(bins);
  const std::string order = node_.get_parameter("order").as_string();
  if (order != "angle" && order != "time")
    throw std::invalid_argument("order: '" + order + "' is not one of angle, time");
  if (order == "time") made.order = g4lidar::scan_order::time;
  if (const auto wrong = g4lidar::problem_with(lidar))
    throw std::invalid_argument(wrong->message());
  return made;
}

std::chrono::nanoseconds node_parameters::connect_timeout() const {
  const std::chrono::duration<double> wait(node_.get_parameter("connect_timeout").as_double());
  return std::chrono::duration_cast<std::chrono::nanoseconds>(wait);
}

bool node_parameters::starts_itself() const { return node_.get_parameter("autostart").as_bool(); }

bool node_parameters::is_standby() const { return node_.get_parameter("standby").as_bool(); }

}  // namespace g4lidar_ros
