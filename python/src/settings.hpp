// SPDX-License-Identifier: MIT
// The settings of a lidar as keyword arguments.
#pragma once

#include <nanobind/stl/optional.h>

#include <optional>
#include <string>
#include <vector>

#include "errors.hpp"
#include "g4lidar/setting_table.hpp"
#include "words.hpp"

namespace g4lidar::python {

/// What a call sets; None stays as the device has it.
struct wanted_settings {
  std::optional<double> frequency_hz;
  std::optional<int> sample_rate_hz;
  std::optional<motor_direction> direction;
  std::optional<bool> constant;
  std::optional<bool> idle;
  std::optional<bool> protection;

  /// The values, in the order of the table. Raises BadOption for one that a G4 does not have.
  [[nodiscard]] std::vector<answer> values() const {
    std::vector<answer> all;
    if (sample_rate_hz) {
      const auto rate = value_of(all_settings()[0], *sample_rate_hz);
      if (!rate) refuse("sample_rate_hz: 4000, 8000 or 9000, not ", nb::cast(*sample_rate_hz));
      all.push_back(*rate);
    }
    if (frequency_hz) {
      const auto wanted = scan_frequency::hz(*frequency_hz);
      if (!is_valid(wanted)) refuse("frequency_hz: 5 to 12, not ", nb::cast(*frequency_hz));
      all.emplace_back(wanted);
    }
    if (direction) all.emplace_back(*direction);
    if (constant) all.emplace_back(*constant ? constant_frequency::on : constant_frequency::off);
    if (idle) {
      all.emplace_back(*idle ? low_power::on : low_power::off);
    }
    if (protection) {
      all.emplace_back(*protection ? power_down_protection::on : power_down_protection::off);
    }
    return all;
  }

 private:
  [[noreturn]] static void refuse(const char* what, const nb::object& given) {
    raise(
        error(task::configuring, problem::bad_option, std::string(what) + nb::repr(given).c_str()));
  }
};

}  // namespace g4lidar::python
