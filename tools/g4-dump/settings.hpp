// SPDX-License-Identifier: MIT
// The settings of a G4 by their names: as words, as JSON, and as what is asked of the device.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "g4lidar/lidar.hpp"
#include "g4lidar/request.hpp"

namespace g4_dump {

enum class setting : unsigned char { rate, freq, direction, constant, idle, protection };

inline constexpr std::array<setting, 6> all_settings{setting::rate,      setting::freq,
                                                     setting::direction, setting::constant,
                                                     setting::idle,      setting::protection};

/// The word for it, which `set` takes; it lives for ever.
[[nodiscard]] std::string_view name_of(setting which) noexcept;

/// Whether a G4 can be asked for it. Two of them it only tells when they are set.
[[nodiscard]] bool can_be_read(setting which) noexcept;

/// A setting and the request that makes it so.
struct wish {
  setting which;
  g4lidar::request how;
  g4lidar::answer value;  ///< As the device answers when it is so.
};

/// Whether `word` has the form NAME=VALUE: what stands before the first `=` is made of letters. A
/// source has not.
[[nodiscard]] bool is_wish(std::string_view word) noexcept;

/// "rate=9k". Throws bad_value, with what is possible.
[[nodiscard]] wish wish_of(const std::string& word);

/// What the device says; nothing where it cannot be asked, or does not answer that. Throws a failure
/// where there is no device any more.
[[nodiscard]] std::optional<g4lidar::answer> read_setting(g4lidar::lidar& lidar, setting which);

/// "9k", "7.0", "cw", "on"; "unknown" where there is nothing.
[[nodiscard]] std::string text_of(const std::optional<g4lidar::answer>& value);

/// 9000, 7.0, "cw", true; null where there is nothing.
[[nodiscard]] nlohmann::ordered_json json_of(const std::optional<g4lidar::answer>& value);

}  // namespace g4_dump
