// SPDX-License-Identifier: MIT
// g4-ros2: lidars as ROS 2 topics, without a ROS installation.
#include <algorithm>
#include <memory>
#include <string_view>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "node.hpp"
#include "ros2_options.hpp"

namespace g4_tool {
namespace {

constexpr const char* description =
    R"(g4-ros2 publishes the scans of one or more YDLIDAR lidars as ROS 2 topics. It needs no ROS
installation: it speaks DDS itself. Every ROS 2 from Humble on sees its topics, with rviz2, Nav2 and
slam_toolbox, if it uses a DDS middleware. Without a source it takes the only lidar that is connected,
waits for it if it is not there yet, and reconnects.)";

constexpr const char* details =
    R"(Topics:
  scan           sensor_msgs/LaserScan, always the same number of ranges
  points         sensor_msgs/PointCloud2 of the returns, with the field t (ns since the stamp)
  /diagnostics   diagnostic_msgs/DiagnosticArray, once a second
  /tf_static     the place of the lidar on the robot, with --mount
  odom, /tf      the way of the robot, of a recording with odometry or a simulated robot
  /clock         the time of a recording
  NODE/run       subscribed, std_msgs/Bool: false rests the motors, true lets them turn

--announce auto announces the node in the form of the release that ROS_DISTRO names, and not at all
without it.

Several lidars have names: front=/dev/ttyUSB0 rear=/dev/ttyUSB1. Then each name is a namespace,
and begins the frame of its lidar: front_laser. --merge publishes one scan and one cloud of all
of them in the frame of the robot instead.

The domain is that of ROS_DOMAIN_ID; ROS_LOCALHOST_ONLY, ROS_AUTOMATIC_DISCOVERY_RANGE,
ROS_STATIC_PEERS and CYCLONEDDS_URI are honoured. Parameters, services and --ros-args are those of
the node in the ROS package g4lidar_ros.
With --deskew odometry the robot's motion is that of the recording or the simulated robot, else of
the subscribed odometry topic.)";

constexpr const char* for_nodes_only =
    "--ros-args is for nodes of ROS, as that of the ROS package g4lidar_ros. Here __ns is "
    "--namespace, __node is --node-name, scan:= is --scan-topic (points, odom, /tf and /tf_static "
    "likewise), the parameter source is SOURCE, a setting such as frequency is --set, another "
    "parameter is the option of its name, --log-level is --verbose, and a file of parameters is "
    "--config, in TOML";

verb make_verb() {
  const auto options = std::make_shared<ros2_options>();
  options->common.frame = frame::robot;
  options->common.on_loss.usual = loss_rule::wait;
  return {.name = "g4-ros2",
          .summary = "Publish lidars as ROS 2 topics",
          .arguments = {named_source_arguments(
              options->sources, "A lidar or a recording, or NAME=SOURCE (the only lidar)")},
          .options = ros2_rows(options),
          .details = details,
          .examples = {{"g4-ros2", "Publish the only lidar on /scan and /points"},
                       {"g4-ros2 --namespace robot1 --mount 0.2,0,0 --standby",
                        "On /robot1/scan, with its place, and at rest while nobody subscribes"},
                       {"g4-ros2 front=/dev/ttyUSB0 rear=/dev/ttyUSB1 --merge "
                        "--mount front=0.2,0,0 --mount rear=-0.2,0,180",
                        "Join two lidars into one scan"},
                       {"g4-ros2 sim: --domain 42", "Publish a simulated G4 in domain 42"}},
          .run = [options] { return run_node(*options); }};
}

}  // namespace
}  // namespace g4_tool

int main(int argc, char** argv) {
  using namespace g4_tool;
  const program g4_ros2{.name = "g4-ros2",
                        .title = "YDLIDAR lidars as ROS 2 topics",
                        .description = description,
                        .verbs = [] { return std::vector<verb>{make_verb()}; },
                        .default_verb = "g4-ros2",
                        .has_config = true};
  if (std::find(argv + 1, argv + argc, std::string_view("--ros-args")) != argv + argc) {
    logger::write("g4-ros2: " + with_help(for_nodes_only, "g4-ros2") + "\n");
    return static_cast<int>(exit_code::usage);
  }
  return run_program(g4_ros2, argc, argv);
}
