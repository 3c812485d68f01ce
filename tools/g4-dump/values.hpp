// SPDX-License-Identifier: MIT
// Values of options out of words; what makes no sense is told by a bad_value.
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <system_error>

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

/// A whole number of 64 bits.
[[nodiscard]] std::uint64_t whole_number_of(const std::string& text);

/// What a word stands for; any other is refused with the list of them.
template <class Value>
[[nodiscard]] Value choice_of(const std::string& word,
                              const std::map<std::string, Value>& choices) {
  const auto found = choices.find(word);
  if (found != choices.end()) return found->second;
  std::string known;
  for (const auto& [choice, meaning] : choices) known += (known.empty() ? "" : ", ") + choice;
  throw bad_value(fmt::format("'{}' is none of {}", word, known));
}

/// "10s", "500ms", "1.5min", "2h", "250us": above 0, at most ten years. A number alone: seconds.
[[nodiscard]] std::chrono::nanoseconds duration_of(const std::string& text);

/// A place in a recording: as a duration, or 0.
[[nodiscard]] std::chrono::nanoseconds moment_of(const std::string& text);

/// "1G", "500M", "64k": in steps of 1024; "1GB": of 1000. A number alone: bytes.
[[nodiscard]] std::uint64_t byte_count_of(const std::string& text);

/// Two numbers with a colon between, either may be missing: "0.28:16", "-90:90", ":4".
struct number_range {
  double from;
  double to;
};
[[nodiscard]] number_range range_of(const std::string& text, double least, double most);

}  // namespace g4_dump
