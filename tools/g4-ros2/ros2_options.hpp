// SPDX-License-Identifier: MIT
// The options, from the command line and the file of --config.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/common_options.hpp"
#include "cli/named_sources.hpp"
#include "cli/setting_words.hpp"
#include "cli/verbs.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "io/source_word.hpp"

namespace g4_tool {

/// The names of topics. Those that begin with a slash are not in the namespace; "off": no topic.
struct topic_names {
  std::string scan = "scan";
  std::string points = "points";
  std::string diagnostics = "/diagnostics";
  std::string odometry = "odom";
  std::string tf = "/tf";
  std::string tf_static = "/tf_static";
  std::string run{};  ///< Subscribed; empty: ~/run, in the namespace of the node.
};

/// The names of coordinate frames.
struct frame_names {
  std::string lidar = "laser";
  std::string robot = "base_link";
  std::string odometry = "odom";
};

/// The message that announces the node: that of releases up to Humble, or from Iron on; automatic: by
/// ROS_DISTRO.
enum class announced_form : unsigned char { automatic, none, humble, iron };

/// The network and the quality of service.
struct network_options {
  std::optional<std::uint32_t> domain;  ///< Nothing: ROS_DOMAIN_ID.
  std::string interface;
  bool is_reliable = true;
  int depth = 5;
  announced_form announced = announced_form::automatic;
};

struct ros2_options {
  /// Of every lidar; without its source. The filters use the robot's frame.
  common_options common;
  lidar_options source{.playback = {.speed = 1}};
  std::vector<std::string> sources;  ///< "SOURCE", or "NAME=SOURCE".
  std::vector<named_mounting> mounts;
  std::vector<setting_change> settings;
  std::string name_space;        ///< "/robot1"; empty: the root.
  std::string node = "g4lidar";  ///< The name of the node.
  topic_names topics;
  frame_names frames;
  network_options transport;
  scan_order order = scan_order::angle;
  std::optional<std::uint32_t> bins;  ///< default_bins() of the model.
  bool merges = false;
  bool is_standby = false;
};

/// The lidars that the options name, at least one. Throws bad_value.
[[nodiscard]] std::vector<named_source> sources_of(const ros2_options& options);

/// A name of ROS 2 in a namespace: "/robot1/scan". Throws bad_value for an invalid name.
[[nodiscard]] std::string full_name(std::string_view name_space, std::string_view name);

/// The frame of a lidar; the name of one of several is inserted: "robot1/front_laser".
[[nodiscard]] std::string frame_of(const ros2_options& options, std::string_view lidar);

/// The topic that rests and turns the motor; "off": none. In the namespace of the node.
[[nodiscard]] std::string run_topic(const ros2_options& options);

/// The table of options, which writes into `options`.
[[nodiscard]] option_rows ros2_rows(const std::shared_ptr<ros2_options>& options);

}  // namespace g4_tool
