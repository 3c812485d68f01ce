// SPDX-License-Identifier: MIT
// Tables with a row for each enumerator, and numbers that were cast to an enumeration without being one of them.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace g4lidar::detail {

/// The row of an enumerator; the last one for a number that is none. *Pure.*
template <class Row, std::size_t Count, class Enum>
[[nodiscard]] constexpr const Row& row_of(const std::array<Row, Count>& rows, Enum value) noexcept {
  const auto at = static_cast<std::size_t>(value);
  return rows[at < Count ? at : Count - 1];
}
/// The name of an enumerator; "unknown" for a number that is none. *Pure.*
template <std::size_t Count, class Enum>
[[nodiscard]] constexpr std::string_view name_in(const std::array<std::string_view, Count>& names,
                                                 Enum value) noexcept {
  const auto at = static_cast<std::size_t>(value);
  return at < Count ? names[at] : "unknown";
}

}  // namespace g4lidar::detail
