// SPDX-License-Identifier: MIT
// The file of --odometry.
#pragma once

#include <string>
#include <vector>

#include "g4lidar/motion.hpp"

namespace g4_tool {

/// The poses in the file of that name, times ascending. Throws a failure that names the file and the
/// line.
[[nodiscard]] std::vector<g4lidar::stamped_pose> load_odometry(const std::string& path);

}  // namespace g4_tool
