// SPDX-License-Identifier: MIT
// The settings of a lidar as keyword arguments.
#pragma once

#include <nanobind/stl/optional.h>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "enumeration_words.hpp"
#include "errors.hpp"
#include "g4lidar/options/option_table.hpp"
#include "live_lidar.hpp"

namespace g4lidar::python {

/// What the keywords take, in the order of the table; None stays as the device has it.
template <class... Wanted>
struct keyword_types {
  using indices = std::index_sequence_for<Wanted...>;
};
using setting_types =
    keyword_types<std::optional<int>, std::optional<double>, std::optional<motor_direction>,
                  std::optional<bool>, std::optional<bool>, std::optional<bool>>;

/// "frequency_hz": the name in the table, and the unit. Valid forever.
[[nodiscard]] const char* keyword_of(const setting_info& which);
/// The argument of a function for the setting of this index.
[[nodiscard]] inline auto keyword(std::size_t index) {
  return nb::arg(keyword_of(all_settings()[index])) = nb::none();
}

// The value of a setting. Raises BadOption for one that its type cannot hold: the lidar refuses what its model does not
// have.
[[nodiscard]] answer value_for(const setting_info& setting, int wanted);
[[nodiscard]] answer value_for(const setting_info& setting, double wanted);
[[nodiscard]] inline answer value_for(const setting_info& setting, bool wanted) {
  return *value_of(setting, wanted ? 2 : 1);
}
[[nodiscard]] inline answer value_for(const setting_info&, motor_direction wanted) {
  return wanted;
}

/// The values that are given, in the order of the table.
template <class... Wanted>
[[nodiscard]] std::vector<answer> values_of(const std::optional<Wanted>&... wanted) {
  std::vector<answer> all;
  const setting_info* which = all_settings().data();
  const auto add = [&](const auto& given) {
    if (given) all.push_back(value_for(*which, *given));
    ++which;
  };
  (add(wanted), ...);
  return all;
}

/// What is added to each angle, in degrees. Raises NotSupported for a model that has no such offset, and BadOption beyond
/// a turn; null: the model is not known yet.
[[nodiscard]] zero_angle zero_angle_from(double deg, const model* model);

/// Sends each of these values; nothing if the lidar refuses one of them.
void set(live_lidar& lidar, std::vector<answer> wanted, bool interrupt);
/// The settings that can be queried; None where the model does not have one.
[[nodiscard]] nb::dict settings(live_lidar& lidar, bool interrupt);

}  // namespace g4lidar::python
