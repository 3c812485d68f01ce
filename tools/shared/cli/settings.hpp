// SPDX-License-Identifier: MIT
// A device in words: its information, and its settings by their names, as text, JSON and requests.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/core/request.hpp"
#include "g4lidar/lidar.hpp"
#include "rows.hpp"

namespace g4_tool {

struct setting {
  std::string_view name;  ///< The word that `set` takes.
  /// Nothing where a G4 answers only when it is set.
  std::optional<g4lidar::request> question;
  /// The words for its values; of several for one value the first is written. The scan frequency has
  /// numbers instead.
  choices<g4lidar::answer> values;
};

/// All of them, in the order of the help.
[[nodiscard]] const std::vector<setting>& all_settings();

/// What a device has for a setting; nothing where that is not known.
using maybe_answer = std::optional<g4lidar::answer>;

/// A setting and the request that makes it so.
struct wish {
  const setting* which;
  g4lidar::request how;
  g4lidar::answer value;  ///< As the device answers when it is so.
};

/// "sample_rate=4k", "freq=5": examples for completion.
[[nodiscard]] std::vector<std::string> example_wishes();

/// Whether `word` has the form NAME=VALUE: only letters, `-` and `_` before the first `=`. A source
/// does not.
[[nodiscard]] bool is_wish(std::string_view word) noexcept;

/// "sample_rate=9k". Throws bad_value, with what is possible.
[[nodiscard]] wish wish_of(const std::string& word);

/// What the device answers; nothing if it cannot be asked for this, or does not answer. Throws a
/// failure if the device is lost.
[[nodiscard]] maybe_answer read_setting(g4lidar::lidar& lidar, const setting& which);

/// "9k", "7.0", "cw", "on"; "unknown" where there is nothing.
[[nodiscard]] std::string text_of(const maybe_answer& value);

/// 9000, 7.0, "cw", true; null where there is nothing.
[[nodiscard]] nlohmann::ordered_json json_of(const maybe_answer& value);

/// "3.2"
[[nodiscard]] std::string firmware_of(const g4lidar::device_information& who);

/// An object with model, serial, firmware and hardware, which are null where nothing is known.
[[nodiscard]] nlohmann::ordered_json json_of(const std::optional<g4lidar::device_information>& who);

}  // namespace g4_tool
