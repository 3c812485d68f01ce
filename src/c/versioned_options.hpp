// SPDX-License-Identifier: MIT
// Options of callers that were compiled with another version of the interface.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <functional>
#include <string_view>

namespace g4lidar::c {

/// Sets the defaults of options that have `size` bytes for the caller.
template <class Options>
void set_defaults(Options* options, std::size_t size, const Options& defaults) noexcept {
  if (options == nullptr || size < sizeof(std::size_t)) return;
  std::memset(static_cast<void*>(options), 0, size);
  std::memcpy(static_cast<void*>(options), &defaults, std::min(size, sizeof(Options)));
  std::memcpy(static_cast<void*>(options), &size, sizeof size);
}

/// The size of options in the first version of the interface: all of them ended with `reserved`.
/// Members that are added follow it; layout.cpp has the numbers.
template <class Options>
inline constexpr std::size_t first_size = offsetof(Options, reserved) + sizeof(Options::reserved);

/// Copies the options of a caller, if there are any, over the defaults in `into`. False if they are
/// shorter than in the first version, or if a member that this version does not know is not 0.
template <class Options>
[[nodiscard]] bool take_options(const Options* given, Options& into) noexcept {
  constexpr std::size_t longest = 4096;  // more is no size, but memory that was not initialised
  if (given == nullptr) return true;
  const std::size_t size = given->struct_size;
  if (size < first_size<Options> || size > longest) return false;
  const std::size_t known = std::min(size, sizeof(Options));
  std::memcpy(&into, given, known);
  const auto* const bytes = reinterpret_cast<const unsigned char*>(given);
  const auto is_zero = [](unsigned char each) { return each == 0; };
  return std::all_of(bytes + offsetof(Options, reserved), bytes + first_size<Options>, is_zero) &&
         std::all_of(bytes + known, bytes + size, is_zero);
}
/// What the function `is_cancelled` of options asks; nothing if there is none.
template <class Options>
[[nodiscard]] std::function<bool()> question_of(const Options& taken) {
  if (taken.is_cancelled == nullptr) return {};
  return [ask = taken.is_cancelled, context = taken.context] { return ask(context); };
}

inline constexpr std::string_view bad_options =
    "options without their _init function, or of a newer version of this library";

}  // namespace g4lidar::c
