// SPDX-License-Identifier: MIT
// A device in words: its information, and its settings by their names, as text, JSON and requests.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "g4lidar/options/lidar_parameters.hpp"
#include "g4lidar/options/option_table.hpp"

namespace g4_tool {

/// What a device has for a setting; nothing where that is not known.
using maybe_answer = std::optional<g4lidar::answer>;

/// A setting, and the value that it is to get.
struct setting_change {
  const g4lidar::setting_info* which;
  g4lidar::answer value;
};

/// "sample_rate=4k", "frequency=5": examples for completion.
[[nodiscard]] std::vector<std::string> example_changes();

/// "4k|8k|9k", "3..16": what is possible, for a help.
[[nodiscard]] std::string values_of(const g4lidar::setting_info& which);

/// Whether `word` has the form NAME=VALUE: only letters, `-` and `_` before the first `=`. A source
/// does not.
[[nodiscard]] bool is_change(std::string_view word) noexcept;

/// "sample_rate=9k". Throws bad_value, with what is possible with a lidar of this model, or of any if that is null.
[[nodiscard]] setting_change change_of(const std::string& word,
                                       const g4lidar::model* model = nullptr);

/// What the device answers; nothing if it cannot be asked for this, or does not answer. Throws a
/// failure if the device is lost.
[[nodiscard]] maybe_answer read_setting(g4lidar::lidar& lidar,
                                        const g4lidar::setting_info& setting);

/// "9k", "7.0", "cw", "on"; "unknown" where there is nothing.
[[nodiscard]] std::string text_of(const maybe_answer& value);

/// 9000, 7.0, "cw", true; null where there is nothing.
[[nodiscard]] nlohmann::ordered_json json_of(const maybe_answer& value);
[[nodiscard]] nlohmann::ordered_json json_of(const g4lidar::parameter_value& value);

/// "3.2"
[[nodiscard]] std::string firmware_of(const g4lidar::device_information& who);

/// An object with model, serial, firmware and hardware, which are null where nothing is known.
[[nodiscard]] nlohmann::ordered_json json_of(const std::optional<g4lidar::device_information>& who);
/// The word of the first model, and those of all: they send the same bytes. Null if there is none.
[[nodiscard]] nlohmann::ordered_json json_of(std::span<const g4lidar::model* const> candidates);

}  // namespace g4_tool
