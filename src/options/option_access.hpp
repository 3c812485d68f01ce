// SPDX-License-Identifier: MIT
// How the options of opening are set, compared and copied.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/number_text.hpp"
#include "g4lidar/lidar_options.hpp"
#include "g4lidar/options/option_table.hpp"

namespace g4lidar {

inline constexpr std::uint8_t is_bool = 1;
inline constexpr std::uint8_t is_integer = 2;
inline constexpr std::uint8_t is_double = 3;
inline constexpr std::uint8_t is_string = 4;

/// Of an option of opening; `number` is its value in the unit of its row, null if that has no limits.
struct option_access {
  bool (*differs)(const lidar_options& a, const lidar_options& b);
  void (*copy)(lidar_options& changed, const lidar_options& source);
  /// `value` has the type of the row, and is in its range. Why not, or empty.
  std::string (*set)(lidar_options& into, const parameter_value& value);
  std::int64_t (*number)(const lidar_options& of);
};

/// The value with the type of the parameter; why not, with its name. *Allocates.*
[[nodiscard]] text_result<parameter_value> value_for(const parameter& to,
                                                     const parameter_value& value);
/// As a person writes it. *Allocates.*
[[nodiscard]] std::string word_of(const parameter_value& value);

}  // namespace g4lidar
