// SPDX-License-Identifier: MIT
// The settings of a lidar as keyword arguments.
#pragma once

#include <nanobind/stl/optional.h>

#include <optional>
#include <string>

#include "errors.hpp"
#include "g4lidar/settings.hpp"
#include "words.hpp"

namespace g4lidar::python {

/// What a call sets; None stays as the device has it.
struct wanted_settings {
  std::optional<double> frequency_hz;
  std::optional<int> sample_rate_hz;
  std::optional<motor_direction> direction;
  std::optional<bool> constant;
  std::optional<bool> low_power;
  std::optional<bool> protection;

  /// Raises BadOption for a rate that a G4 does not have.
  [[nodiscard]] std::optional<g4lidar::sample_rate> sample_rate() const {
    if (!sample_rate_hz) return std::nullopt;
    for (const auto each :
         {g4lidar::sample_rate::khz_4, g4lidar::sample_rate::khz_8, g4lidar::sample_rate::khz_9}) {
      if (static_cast<int>(to_hz(each)) == *sample_rate_hz) return each;
    }
    raise(error(task::configuring, problem::bad_option,
                "sample_rate_hz: 4000, 8000 or 9000, not " + std::to_string(*sample_rate_hz)));
  }
  [[nodiscard]] std::optional<scan_frequency> frequency() const {
    if (!frequency_hz) return std::nullopt;
    const auto wanted = scan_frequency::hz(*frequency_hz);
    if (!is_valid(wanted))
      raise(error(
          task::configuring, problem::bad_option,
          std::string("frequency_hz: 5 to 12, not ") + nb::repr(nb::cast(*frequency_hz)).c_str()));
    return wanted;
  }
  [[nodiscard]] std::optional<constant_frequency> constancy() const {
    if (!constant) return std::nullopt;
    return *constant ? constant_frequency::on : constant_frequency::off;
  }
  [[nodiscard]] std::optional<g4lidar::low_power> idle() const {
    if (!low_power) return std::nullopt;
    return *low_power ? g4lidar::low_power::on : g4lidar::low_power::off;
  }
  [[nodiscard]] std::optional<power_down_protection> protecting() const {
    if (!protection) return std::nullopt;
    return *protection ? power_down_protection::on : power_down_protection::off;
  }
};

}  // namespace g4lidar::python
