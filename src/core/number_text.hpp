// SPDX-License-Identifier: MIT
// Numbers from text and as text, independent of the locale; lists of words.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>

#include <tl/expected.hpp>

#include "printable_text.hpp"

namespace g4lidar {

/// A value, or why the text is not valid.
template <class Value>
using text_result = tl::expected<Value, std::string>;

/// "'east'": a word of a user or of a file in a message, as one line, and not more than its begin.
inline std::string in_quotes(std::string_view text) {
  constexpr std::size_t enough = 40;
  std::string quoted = "'";  // appended to: g++ 12 warns of other forms without a reason
  each_printable(text.substr(0, enough), [&quoted](std::string_view piece) { quoted += piece; });
  return quoted.append(text.size() > enough ? "...'" : "'");
}

/// "cw, ccw", "4000, 8000 or 9000": the texts of all, with `last` before the last one.
template <class Range, class TextOf = std::identity>
std::string list_of(const Range& all, TextOf text_of = {}, std::string_view last = ", ") {
  std::string made;
  for (const auto& each : all) {
    if (!made.empty()) made.append(&each == &*std::prev(std::end(all)) ? last : ", ");
    made.append(std::invoke(text_of, each));
  }
  return made;
}

/// As a person writes it: 5, 0.28.
inline std::string text_of_number(double value) {
  std::array<char, 64> text;
  const bool is_whole = value == std::floor(value) && std::fabs(value) < 1e15;
  const auto end = is_whole ? std::to_chars(text.data(), text.data() + text.size(),
                                            static_cast<std::int64_t>(value))
                            : std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end.ptr};
}

/// Any finite number, rounded as printf does.
inline std::string with_decimals(double value, int decimals) {
  std::array<char, 400> text;  // the largest double has 309 digits
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value,
                                 std::chars_format::fixed, decimals);
  return {text.data(), end.ptr};
}

inline std::string not_in_range(std::string_view text, double least, double most) {
  return in_quotes(text) + " is not in the range " + text_of_number(least) + " to " +
         text_of_number(most);
}

/// The number that is all of `text`.
inline text_result<double> number_in(std::string_view text, double least, double most) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [at, wrong] = std::from_chars(text.data(), end, value);
  if (wrong != std::errc() || at != end || !(least <= value && value <= most))
    return tl::unexpected(not_in_range(text, least, most));
  return value;
}

}  // namespace g4lidar
