// SPDX-License-Identifier: MIT
// The types of ROS 2 messages on the wire.
#pragma once

#include <dds/dds.h>

#include <string_view>

namespace g4_tool::dds {

/// The descriptor of a type for Cyclone DDS, and the hash of its definition (REP 2011), by which newer
/// releases of ROS 2 compare definitions. Static.
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
extern const message_type bool_message;

}  // namespace g4_tool::dds
