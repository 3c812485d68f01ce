// SPDX-License-Identifier: MIT
// The table of options: what a lidar and its scans can be set to, by name. The command lines, the parameters of nodes,
// the keywords of Python and the tables of documents are made from it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/lidar_options.hpp"
#include "g4lidar/transport/recognition.hpp"

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

/// The index is the type in rcl_interfaces/ParameterType. Nothing: not known yet.
using parameter_value = std::variant<std::monostate, bool, std::int64_t, double, std::string>;
/// A parameter by its name.
using named_value = std::pair<std::string, parameter_value>;

/// What a parameter changes.
enum class parameter_kind : std::uint8_t {
  device,     ///< A setting of the device, made while it scans.
  filter,     ///< What is published of the next scans.
  read_only,  ///< Nothing: it cannot change while the program runs.
  program,    ///< What the program does that has it; the library does not use it.
};

/// What can use an option; bits of a set.
namespace option_user {
inline constexpr std::uint8_t live = 1;       ///< A port, a network bridge, `sim:`.
inline constexpr std::uint8_t recording = 2;  ///< A file with times.
inline constexpr std::uint8_t raw_file = 4;   ///< A file of raw bytes.
inline constexpr std::uint8_t pipe = 8;       ///< Raw bytes as they come.
inline constexpr std::uint8_t port =
    16;  ///< Beside `live`: a port of this computer, which may be searched.
inline constexpr std::uint8_t file = recording | raw_file;      ///< Both.
inline constexpr std::uint8_t any = live | file | pipe | port;  ///< All.
}  // namespace option_user

/// Who has an option; bits of a set: some commands, the node of ROS 2 as a parameter, open() of Python.
namespace option_door {
inline constexpr std::uint8_t tool = 1;    ///< A command.
inline constexpr std::uint8_t node = 2;    ///< The node of ROS 2.
inline constexpr std::uint8_t python = 4;  ///< open() of Python.
}  // namespace option_door

struct option_access;

/// A row of the table.
struct parameter {
  std::string_view name{};                          ///< "range_min".
  std::uint8_t type = 0;                            ///< The index in parameter_value.
  parameter_kind kind = parameter_kind::read_only;  ///< What it changes.
  std::string_view text{};     ///< "Shortest range that is kept", without a full stop.
  std::string_view details{};  ///< More about it.
  std::string_view unit{};     ///< Of a number: "m"; else empty.
  std::string_view form{};     ///< Of a text: "FROM:TO"; of a number in a help: "N".
  std::string_view usual{};    ///< The value where none is given, as text; empty: see `unset`.
  std::string_view unset{};    ///< What is used where none is given: "searched".
  /// The words that it may be; the names of the limits of a mark, which may also be off and on.
  std::span<const std::string_view> words{};
  std::uint8_t node_words = 0;    ///< How many of the last words only the node has.
  std::array<double, 3> range{};  ///< From, to, step, of all models together; all 0: none.
  std::uint8_t users = option_user::any;
  std::uint8_t doors = 0;
  std::string_view flag{};       ///< On the command line, if not the name with dashes: "--listen".
  std::string_view node_name{};  ///< In ROS, if it is not the name.
  const setting_info* setting = nullptr;  ///< Of a device.
  const option_access* access = nullptr;  ///< How it is set; null: by the program that has it.

  /// Whether this door has it.
  [[nodiscard]] constexpr bool is_of(std::uint8_t door) const noexcept {
    return (doors & door) != 0;
  }
};

/// The values that a parameter can have.
struct parameter_limits {
  std::string constraints{};      ///< Where they are not a range.
  std::array<double, 3> range{};  ///< From, to, step; all 0: none.
};

/// All of them. *Pure.* Valid forever.
[[nodiscard]] G4LIDAR_API std::span<const parameter> all_parameters() noexcept;
/// Null if there is none. *Pure.*
[[nodiscard]] G4LIDAR_API const parameter* find_parameter(std::string_view name) noexcept;
/// "Shortest range that is kept, m": the text with unit, details, and what is used where it is not given. *Allocates.*
[[nodiscard]] G4LIDAR_API std::string description_of(const parameter& of);
/// The values with a lidar of this model, which may not have the setting; null: with those of all models. *Allocates.*
[[nodiscard]] G4LIDAR_API parameter_limits limits_of(const parameter& parameter,
                                                     const model* model = nullptr);
/// Its name on the command line: "--near-as". *Allocates.*
[[nodiscard]] G4LIDAR_API std::string flag_of(const parameter& of);

/// The value as one of a type, the index in parameter_value, as people write it: 10 or "10" for 10.0, "on" or "true" for
/// true, true or "true" for "on", an infinite number for "inf". Nothing if it is none. *Allocates.*
[[nodiscard]] G4LIDAR_API parameter_value converted(const parameter_value& value,
                                                    std::uint8_t type);
/// The value of a setting as the device gave it; nothing for an answer that is of none.
[[nodiscard]] G4LIDAR_API parameter_value value_of(const answer& given);
/// The value that a setting is to have; errors as those of value_in().
[[nodiscard]] G4LIDAR_API result<answer> answer_of(const setting_info& setting,
                                                   const parameter_value& wanted,
                                                   const model* model = nullptr);
/// Sets an option of opening. Returns why the value is not valid, without its name, and then changes nothing; empty if
/// it is set. *Allocates.*
[[nodiscard]] G4LIDAR_API std::string set_option(lidar_options& into, const parameter& parameter,
                                                 const parameter_value& value);

}  // namespace g4lidar
