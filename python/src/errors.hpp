// SPDX-License-Identifier: MIT
// Errors of the library as exceptions: one class per problem, in g4lidar/errors.py.
#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/error.hpp"

namespace g4lidar::python {

namespace nb = nanobind;

/// Raises the class of the problem, or what a handler of a signal has raised. Needs the GIL.
[[noreturn]] void raise(const error& why);
/// Raises BadOption with this text, for what the library refuses by a sentence.
[[noreturn]] void raise_bad_option(const std::string& text);
/// The model of this word; null for None. Raises BadOption.
[[nodiscard]] const model* model_of(const std::optional<std::string>& word);
/// The same; None: a G4, the model of points and bytes that do not state theirs.
[[nodiscard]] const model& model_or_g4(const std::optional<std::string>& word);
/// The words of these models.
[[nodiscard]] std::vector<std::string_view> words_of(std::span<const model* const> which);
/// ValueError: "WHAT, not GIVEN": which values are possible, and the one that was given.
template <class Value>
[[noreturn]] void raise_impossible(const std::string& what, const Value& given) {
  throw nb::value_error((what + ", not " + nb::repr(nb::cast(given)).c_str()).c_str());
}

/// The value, or raise().
template <class Value>
[[nodiscard]] Value value_of(result<Value>&& given) {
  if (!given) raise(given.error());
  if constexpr (!std::is_void_v<Value>) return *std::move(given);
}
/// Raises the error, if there is one.
inline void check(const result<void>& given) {
  if (!given) raise(given.error());
}

/// Nanoseconds of a time since the beginning of a file, or of a delay. Raises ValueError.
[[nodiscard]] inline std::int64_t in_ns(double seconds) {
  if (!(seconds >= 0.0 && seconds <= 1e9))
    raise_impossible("a number of seconds is 0 to 1e9", seconds);
  return static_cast<std::int64_t>(seconds * 1e9);
}

/// Defines what g4lidar/errors.py needs.
void bind_errors(nb::module_& module);

}  // namespace g4lidar::python
