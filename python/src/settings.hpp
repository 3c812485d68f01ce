// SPDX-License-Identifier: MIT
// The settings of a lidar as keyword arguments.
#pragma once

#include <nanobind/stl/optional.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "errors.hpp"
#include "g4lidar/setting_table.hpp"
#include "live_lidar.hpp"
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

  /// The values, in the order of the table. Raises BadOption for one that its type cannot hold: the lidar refuses what
  /// its model does not have.
  [[nodiscard]] std::vector<answer> values() const {
    std::vector<answer> all;
    if (sample_rate_hz) {
      const int hz = *sample_rate_hz;
      if (hz < 0 || hz > UINT16_MAX) refuse("sample_rate_hz: 0 to 65535, not ", nb::cast(hz));
      all.emplace_back(sample_rate{static_cast<std::uint16_t>(hz)});
    }
    if (frequency_hz) {
      const double hz = *frequency_hz;
      if (!(hz >= 0.0 && hz <= 655.0)) refuse("frequency_hz: 0 to 655, not ", nb::cast(hz));
      all.emplace_back(scan_frequency::hz(hz));
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

/// Sends each setting that is given; nothing if the lidar refuses one of them.
void set(live_lidar& on, const wanted_settings& wanted, bool interrupt);
/// The settings that can be queried; None where the model does not have one.
[[nodiscard]] nb::dict settings(live_lidar& on, bool interrupt);

}  // namespace g4lidar::python
