// SPDX-License-Identifier: MIT
// Words and numbers of text files that people write.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "core/number_text.hpp"

namespace g4lidar {

/// Takes the next line from the front of `text`, without its end and without a comment.
[[nodiscard]] inline std::string_view next_line(std::string_view& text) noexcept {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line.substr(0, line.find('#'));
}

/// Takes the next word from the front of `line`; empty at its end.
[[nodiscard]] inline std::string_view next_word(std::string_view& line) noexcept {
  constexpr std::string_view spaces = " \t\r";
  line.remove_prefix(std::min(line.find_first_not_of(spaces), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(spaces));
  line.remove_prefix(word.size());
  return word;
}

/// A finite number that is the whole word; it may have a plus sign.
[[nodiscard]] inline std::optional<double> number_in(
    std::string_view word, std::chars_format format = std::chars_format::general) noexcept {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  double value = 0.0;
  const char* const end = word.data() + word.size();
  const auto [at, error] = std::from_chars(word.data(), end, value, format);
  if (error != std::errc() || at != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace g4lidar
