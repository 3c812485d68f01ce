// SPDX-License-Identifier: MIT
// What a recording contains about its lidar.
#pragma once

#include <optional>

#include "g4lidar/core/request.hpp"
#include "g4lidar/device_information.hpp"
#include "g4lidar/recognition.hpp"
#include "g4lidar/settings.hpp"

namespace g4lidar {

/// What is known about the recorded lidar: a metadata record of each file, "g4lidar.device".
/// Settings that were not queried are not known.
struct recorded_device {
  device_information information{};
  std::optional<g4lidar::sample_rate> sample_rate{};
  std::optional<scan_frequency> frequency{};
  std::optional<motor_direction> motor{};
  std::optional<constant_frequency> constant{};
  std::optional<low_power> idle{};
  std::optional<power_down_protection> protection{};
  /// As which model the lidar was read, if something contradicts that: contradictions_of(). Without candidates. The
  /// driver records it; a device() without it leaves it as it is.
  std::optional<recognition> recognised{};
};

}  // namespace g4lidar
