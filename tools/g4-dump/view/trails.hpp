// SPDX-License-Identifier: MIT
// What stays where the walls are, of a robot whose motion is known: earlier returns, and the way driven.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "cli/exit_code.hpp"
#include "g4lidar/lidar_service.hpp"
#include "g4lidar/scan.hpp"
#include "radar.hpp"

namespace g4_tool {

/// *Single thread.*
class trails {
 public:
  void add(const g4lidar::scan& newest, const std::optional<lidar_place>& place);
  /// Off, 2 s, 10 s.
  void change_length();
  [[nodiscard]] int length_s() const noexcept { return length_s_; }
  [[nodiscard]] bool has_map() const noexcept { return place_.has_value(); }
  /// Sets what is to be drawn, and where. `wants_map`: in the map, if there is one; else in the robot's frame.
  /// Views this, until the next call of any function.
  void show(radar_view& view, bool wants_map);

 private:
  struct revolution {
    std::int64_t time_ns;
    std::vector<g4lidar::xy_point> returns;  // in the map
  };

  std::optional<lidar_place> place_;
  std::deque<revolution> kept_;
  std::vector<g4lidar::xy_point> way_;
  std::vector<g4lidar::xy_point> shown_;
  pose_2d middle_;  // of the picture, in the map
  int length_s_ = 0;
};

}  // namespace g4_tool
