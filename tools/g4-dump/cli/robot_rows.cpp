// SPDX-License-Identifier: MIT
#include "robot_rows.hpp"

#include <array>
#include <numbers>
#include <string_view>

#include "logger.hpp"
#include "rows.hpp"

namespace g4_dump {
namespace {

/// "0.1,0,180" or "0.1,0,180,down".
g4lidar::mounting mounting_of(const std::string& word) {
  constexpr std::string_view down = ",down";
  g4lidar::mounting made;
  std::string rest = word;
  made.upside_down = word.ends_with(down);
  if (made.upside_down) rest.resize(rest.size() - down.size());
  std::array<double, 3> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t comma = rest.find(',');
    if ((comma == std::string::npos) != (i == 2)) {
      throw bad_value(in_quotes(word) + " is not X,Y,YAW_DEG or X,Y,YAW_DEG,down");
    }
    values.at(i) = number_of(rest.substr(0, comma), -1000.0, 1000.0);
    if (i < 2) rest.erase(0, comma + 1);
  }
  made.pose = {values[0], values[1], values[2] * std::numbers::pi / 180.0};
  return made;
}

}  // namespace

option_rows robot_rows(robot_options& into) {
  return in_group(
      "The robot",
      {text_row("--odometry", "FILE", "The robot's way: lines of time_ns, x, y and yaw_rad",
                into.odometry),
       value_row("--mount", "X,Y,YAW_DEG[,down]",
                 "Place of the lidar on the robot in m; down: top down", into.mount, mounting_of)});
}

}  // namespace g4_dump
