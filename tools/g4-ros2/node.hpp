// SPDX-License-Identifier: MIT
// All lidars of one process in a ROS 2 domain.
#pragma once

#include "ros2_options.hpp"

namespace g4_tool {

/// Publishes until ^C, the end of all recordings, or --duration. Returns the exit code; throws a failure or
/// bad_value.
[[nodiscard]] int run_node(const ros2_options& options);

}  // namespace g4_tool
