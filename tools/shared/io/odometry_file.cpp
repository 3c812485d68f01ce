// SPDX-License-Identifier: MIT
#include "odometry_file.hpp"

#include "g4lidar/export/odometry_text.hpp"
#include "text_file.hpp"

namespace g4_tool {

std::vector<g4lidar::stamped_pose> load_odometry(const std::string& path) {
  return load_text<std::vector<g4lidar::stamped_pose>>(
      path, 1024, "Give a file with lines 'time_ns x y yaw_rad'.", g4lidar::parse_odometry);
}

}  // namespace g4_tool
