// SPDX-License-Identifier: MIT
// The picture of `g4-dump view`: the radar, and a panel with facts about the lidar.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "canvas.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/point.hpp"
#include "radar.hpp"

namespace g4_tool {

/// The contents of the panel. Numbers below 0 are unknown.
struct view_facts {
  std::string name{};  ///< Of the source.
  std::string state{};
  std::string why{};
  std::string serial{};
  std::string event{};  ///< The last one.
  double frequency_hz = -1;
  double sample_rate_hz = -1;
  double lost_percent = -1;
  std::int64_t checksum_errors = -1;
  std::int64_t scans = -1;
  /// The least and the greatest of the newest revolution; nothing if the model does not measure it.
  std::optional<std::pair<int, int>> intensity{};
  double position_s = -1;  ///< In a recording.
  double length_s = -1;
  std::vector<g4lidar::stage_report> stages{};
};

/// The choices of the user.
struct view_settings {
  radar_view radar{};
  bool is_zoomed = false;  ///< The user has chosen the range; else it follows the returns.
  bool is_frozen = false;
  bool wants_map = false;  ///< Where the motion is known.
  bool shows_help = false;
};

/// Draws the picture on a canvas of any size. Without room for the panel its facts are in one line below the
/// radar; without room for the radar there is only that line.
void draw_view(canvas& canvas, std::span<const g4lidar::point> points, const view_facts& facts,
               const view_settings& settings);

}  // namespace g4_tool
