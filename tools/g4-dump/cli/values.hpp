// SPDX-License-Identifier: MIT
// Parses the values of options; a value that is not valid is refused by a bad_value.
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "verb.hpp"

namespace g4_dump {

/// A number from `least` to `most`, all of `text`. Without exponent tricks: 9000, 0.5, 1e3.
template <class Value>
[[nodiscard]] Value number_of(const std::string& text, Value least, Value most) {
  Value value{};
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || at != end || !(least <= value && value <= most)) {
    throw bad_value(fmt::format("'{}' is not in the range {} to {}", text, least, most));
  }
  return value;
}

/// Words and what they stand for, in the order of the help.
template <class Value>
using choices = std::vector<std::pair<std::string, Value>>;

/// The words with `between` between them.
template <class Value>
[[nodiscard]] std::string words_of(const choices<Value>& known, std::string_view between) {
  std::string words;
  for (const auto& [word, meaning] : known) words.append(words.empty() ? "" : between).append(word);
  return words;
}

/// What a word stands for; any other is refused with the list of them.
template <class Value>
[[nodiscard]] Value choice_of(const std::string& word, const choices<Value>& known) {
  for (const auto& [choice, meaning] : known) {
    if (choice == word) return meaning;
  }
  throw bad_value(fmt::format("'{}' is not one of {}", word, words_of(known, ", ")));
}

/// "10s", "500ms", "1.5min", "2h", "250us": above 0, at most ten years. A number alone: seconds.
[[nodiscard]] std::chrono::nanoseconds duration_of(const std::string& text);

/// A place in a recording in nanoseconds: as a duration, or 0.
[[nodiscard]] std::int64_t moment_of(const std::string& text);

/// "1G", "500M", "64k": in steps of 1024; "1GB": of 1000. A number alone: bytes.
[[nodiscard]] std::uint64_t byte_count_of(const std::string& text);

/// Two numbers with a colon between, either may be missing: "0.28:16", "-90:90", ":4".
struct number_range {
  double from;
  double to;
};
[[nodiscard]] number_range range_of(const std::string& text, double least, double most);

}  // namespace g4_dump
