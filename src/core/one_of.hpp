// SPDX-License-Identifier: MIT
// Whether a value is one of several.
#pragma once

namespace g4lidar {

/// *Pure.*
template <class Value, class... Values>
[[nodiscard]] constexpr bool is_one_of(Value value, Values... any) noexcept {
  return ((value == any) || ...);
}

}  // namespace g4lidar
