// SPDX-License-Identifier: MIT
// What a recording contains about its lidar.
#pragma once

#include <algorithm>
#include <bitset>
#include <cstddef>
#include <optional>
#include <span>

#include "g4lidar/core/model.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/device_information.hpp"
#include "g4lidar/recognition.hpp"
#include "g4lidar/settings.hpp"

namespace g4lidar {

/// Models, by their places in `models`.
using model_set = std::bitset<models.size()>;
/// *Pure.*
[[nodiscard]] inline model_set set_of(std::span<const model* const> of) noexcept {
  model_set all;
  for (std::size_t at = 0; at < models.size(); ++at) {
    all[at] = std::find(of.begin(), of.end(), &models[at]) != of.end();
  }
  return all;
}

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
  /// As which model the lidar was read, if that was a guess, or something contradicts it: contradictions_of(). Its
  /// candidates are below. The driver records it; a device() without it leaves it as it is.
  std::optional<recognition> recognised{};
  /// Of `recognised`: the models between which the bytes did not decide.
  model_set candidates{};

  /// The model of `recognised`, at last. Null: it is not recorded. Valid forever.
  [[nodiscard]] const model* read_as() const noexcept {
    return recognised ? recognised->model : nullptr;
  }
};

}  // namespace g4lidar
