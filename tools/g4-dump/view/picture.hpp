// SPDX-License-Identifier: MIT
// The whole picture of `g4-dump view`: the radar, and beside it what is known about the lidar.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "canvas.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/point.hpp"
#include "radar.hpp"

namespace g4_tool {

/// What stands beside the radar. Numbers below 0 are not known.
struct view_facts {
  std::string name{};   ///< Of the source.
  std::string state{};  ///< Of the station.
  std::string why{};
  std::string serial{};
  std::string event{};  ///< The last one.
  double frequency_hz = -1;
  double sample_rate_hz = -1;
  double lost_percent = -1;
  std::int64_t checksum_errors = -1;
  std::int64_t scans = -1;
  double position_s = -1;  ///< In a recording.
  double length_s = -1;
  std::vector<g4lidar::stage_report> stages{};
};

/// How it is shown.
struct view_settings {
  radar_view radar{};
  bool is_zoomed = false;  ///< By a key: else the range follows the returns.
  bool is_frozen = false;
  bool shows_help = false;
};

/// Draws all of it, on a canvas of any size: without room for the words beside the radar they stand in one line
/// below it, and without room for a radar there is that line only.
void draw_view(canvas& on, std::span<const g4lidar::point> points, const view_facts& facts,
               const view_settings& how);

}  // namespace g4_tool
