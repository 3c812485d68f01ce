// SPDX-License-Identifier: MIT
// The settings of a lidar as a table: names, units, texts, values, and the requests for them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/core/request.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/lidar_options.hpp"
#include "g4lidar/recognition.hpp"

namespace g4lidar {

/// How the values of a setting are written.
enum class setting_type : std::uint8_t {
  whole,    ///< As a whole number: 9000.
  decimal,  ///< As a multiple of a decimal: 7.5.
  word,     ///< As a word: "cw".
  on_off,   ///< As "on" or "off".
};

/// One of a few values.
struct setting_value {
  std::string_view word;  ///< "9k", "cw", "on".
  std::int32_t number;    ///< In the unit of setting_info; of words 1, 2, ...: off is 1, and on 2.
  answer value;           ///< As the device answers when it has this value.
};

/// A row of the table.
struct setting_info {
  std::string_view name;  ///< "sample_rate".
  setting_type type;
  std::string_view unit;  ///< Of the values as they are written: "Hz"; else empty.
  std::string_view text;  ///< "samples per second".
  request_kind change;    ///< Sets it.
  /// Asks for it; nothing where a G4 answers only when it is set.
  std::optional<request> query;
  std::span<const setting_value> values;  ///< If there are only a few; else empty.
  /// The limits and the step of a decimal, whose numbers are in 0.01 of its unit.
  std::int32_t least = 0;
  std::int32_t most = 0;   ///< The highest one.
  std::int32_t step = 10;  ///< Of the values as they are written; others are possible.
};

/// All settings, with the values and the limits of all models together. *Pure.*
[[nodiscard]] G4LIDAR_API std::span<const setting_info> all_settings() noexcept;
/// The setting that an answer is of; null if it is of none. *Pure.*
[[nodiscard]] G4LIDAR_API const setting_info* setting_of(const answer& value) noexcept;
/// The value with a number, which one of the models at least has; nothing if none has it. *Pure.* A lidar
/// refuses what its own model does not have.
[[nodiscard]] G4LIDAR_API std::optional<answer> value_of(const setting_info& setting,
                                                         std::int32_t number) noexcept;
/// The value that `text` states: "9k" or "9000", "7.5", "cw", "on". `model` has it, or one of the models at least where
/// that is null. *Allocates.* Fails with bad_option: subject() has the name of the setting, and the values that are
/// possible, with their unit.
[[nodiscard]] G4LIDAR_API result<answer> value_in(const setting_info& setting,
                                                  std::string_view text,
                                                  const model* model = nullptr);
/// The row of setting_info::values with this value; null if there is none. *Pure.*
[[nodiscard]] G4LIDAR_API const setting_value* find_value(const answer& value) noexcept;
/// The number of a value; nothing if it is of no setting, or none of its values. *Pure.*
[[nodiscard]] G4LIDAR_API std::optional<std::int32_t> number_of(const answer& value) noexcept;
/// The request that sets a value of a setting; of anything else, one that a session refuses. *Pure.*
[[nodiscard]] G4LIDAR_API request change_to(const answer& value) noexcept;
/// How the speed of lidars like `model` is set without commands: "a voltage or PWM at its pin M_SCTR; ..."; empty where
/// a command sets it. *Allocates.*
[[nodiscard]] G4LIDAR_API std::string speed_without_commands(const model& model);
/// What commands set, and how the speed is set without: "commands set nothing; its speed: ...". *Allocates.*
[[nodiscard]] G4LIDAR_API std::string ways_to_set(const model& model);

/// What is known about a model, as text: {"baud", "115200"}.
struct model_fact {
  std::string_view name;  ///< Valid forever.
  std::string text;
};
/// Number, rates, frequency, range, samples, the direction of 0, commands: the row of docs/models.md. *Allocates.*
[[nodiscard]] G4LIDAR_API std::vector<model_fact> facts_of(const model& model);
/// For status messages: model, candidates, known_by; number and baud where they are known; and contradictions where
/// there are some. Empty where no model is known. *Allocates.*
[[nodiscard]] G4LIDAR_API std::vector<model_fact> facts_of(const recognition& what);

/// Sets the option of this setting; nothing for an answer that is of none.
G4LIDAR_API void set_option(lidar_options& options, const answer& value) noexcept;

}  // namespace g4lidar
