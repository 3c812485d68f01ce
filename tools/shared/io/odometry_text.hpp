// SPDX-License-Identifier: MIT
// Odometry from a text, as g4-dump sim --odometry writes it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "g4lidar/motion.hpp"

namespace g4_tool {

/// Why a text is not odometry.
struct odometry_error {
  std::size_t line;     ///< Counted from 1; 0 if there is no pose.
  std::string message;  ///< One sentence without the line number, for people.
};

/// The poses that `text` contains, or the first error in it. Each line is empty, or
/// `time_ns x y yaw`: a whole number of nanoseconds, greater than in the line before, metres and
/// radians; from `#` on a line is a comment. At least one pose. Independent of the locale. Throws
/// only std::bad_alloc.
[[nodiscard]] std::variant<std::vector<g4lidar::stamped_pose>, odometry_error> parse_odometry(
    std::string_view text);

}  // namespace g4_tool
