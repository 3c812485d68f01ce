// SPDX-License-Identifier: MIT
// Options about the robot that carries the lidar.
#pragma once

#include <optional>
#include <string>

#include "g4lidar/motion.hpp"
#include "verbs.hpp"

namespace g4_dump {

/// How the robot moved, and where the lidar is on it.
struct robot_options {
  std::string odometry;                    ///< A file for load_odometry(); empty: none.
  std::optional<g4lidar::mounting> mount;  ///< Where it is given.
};

/// --odometry and --mount.
[[nodiscard]] option_rows robot_rows(robot_options& into);

}  // namespace g4_dump
