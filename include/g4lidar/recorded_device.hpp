// SPDX-License-Identifier: MIT
// What a recording knows of its lidar.
#pragma once

#include <optional>

#include "g4lidar/command.hpp"
#include "g4lidar/request.hpp"
#include "g4lidar/response.hpp"

namespace g4lidar {

/// What is known of the lidar that was recorded: a metadata record of each file, "g4lidar.device".
/// Settings that were not asked for are not known.
struct recorded_device {
  device_information information{};
  std::optional<ranging_frequency> ranging{};
  std::optional<scan_frequency> frequency{};
  std::optional<motor_direction> motor{};
  std::optional<constant_frequency> constant{};
  std::optional<low_power> idle{};
  std::optional<power_down_protection> protection{};
};

}  // namespace g4lidar
