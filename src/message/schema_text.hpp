// SPDX-License-Identifier: MIT
// Definitions of ROS 2 messages, joined from those of their parts.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

namespace g4lidar::schema {

inline constexpr std::string_view header = R"(MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
)";
inline constexpr std::string_view time = R"(MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
)";
inline constexpr std::string_view line =
    "================================================================================\n";

/// The definition of a message and of the messages in it, with a line between them. Without the
/// attribute g++ 14 exports it from a shared library in spite of -fvisibility=hidden.
template <const std::string_view& First, const std::string_view&... Parts>
[[gnu::visibility("hidden")]] inline constexpr auto joined = [] {
  std::array<char, (First.size() + ... + (line.size() + Parts.size()))> all{};
  auto to = std::ranges::copy(First, all.begin()).out;
  for (const std::string_view part : {Parts...}) {
    to = std::ranges::copy(part, std::ranges::copy(line, to).out).out;
  }
  return all;
}();
/// The same as a view.
template <const std::string_view&... Parts>
inline constexpr std::string_view text{joined<Parts...>.data(), joined<Parts...>.size()};

}  // namespace g4lidar::schema
