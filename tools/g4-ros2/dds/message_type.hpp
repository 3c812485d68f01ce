// SPDX-License-Identifier: MIT
// The types of ROS 2 messages on the wire.
#pragma once

#include <dds/dds.h>

#include <string_view>

namespace g4_tool::dds {

/// How Cyclone DDS knows the type, and the hash of its definition (REP 2011), by which newer ROS 2
/// compares definitions. Valid forever.
struct message_type {
  const dds_topic_descriptor_t* descriptor;
  std::string_view hash;
};

extern const message_type laser_scan;
extern const message_type point_cloud2;
extern const message_type odometry;
extern const message_type tf_message;
extern const message_type diagnostic_array;
extern const message_type clock_message;

}  // namespace g4_tool::dds
