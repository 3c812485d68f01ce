// SPDX-License-Identifier: MIT
// Makes rows of the table of options. Each parses its value, refuses one that is not valid by a
// bad_value, and writes into a variable that exists as long as the table.
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cstdint>
#include <functional>
#include <iterator>
#include <ranges>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "suggestion.hpp"
#include "verbs.hpp"

namespace g4_tool {

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
  return fmt::format("{}", fmt::join(known | std::views::keys, between));
}

/// What a word stands for; any other is refused with the list of them and the nearest one.
template <class Value>
[[nodiscard]] Value choice_of(const std::string& word, const choices<Value>& known) {
  for (const auto& [choice, meaning] : known) {
    if (choice == word) return meaning;
  }
  const auto words = known | std::views::keys;
  throw bad_value(fmt::format("'{}' is not one of {}{}", word, words_of(known, ", "),
                              did_you_mean(word, {words.begin(), words.end()})));
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

/// A number that a word such as "window=3,near=0.1" can set.
struct named_number {
  std::string_view name;
  double least;
  double most;
  bool is_whole;
  std::function<void(double)> take;
};
/// Sets the numbers that `text` names; it may be empty.
void take_numbers(const std::string& text, const std::vector<named_number>& known);

/// `into` becomes what `parse` makes of the word; it throws bad_value.
template <class Target, class Parse>
[[nodiscard]] option_row value_row(const char* names, std::string value, const char* help,
                                   Target& into, Parse parse) {
  return {names, std::move(value), help,
          [&into, convert = std::move(parse)](const std::string& word) { into = convert(word); }};
}

/// Becomes true.
[[nodiscard]] inline option_row flag_row(const char* names, const char* help, bool& into) {
  return value_row(names, "", help, into, [](const std::string&) { return true; });
}

template <class Target>
[[nodiscard]] option_row text_row(const char* names, std::string value, const char* help,
                                  Target& into, completion complete = completion::file) {
  option_row row =
      value_row(names, std::move(value), help, into, [](const std::string& word) { return word; });
  row.complete = complete;
  return row;
}

/// An argument that every command line has to have: the name of a file.
[[nodiscard]] inline option_row file_argument(const char* name, const char* help,
                                              std::string& into) {
  option_row row = text_row(name, "", help, into);
  row.required = true;
  return row;
}

/// A time above 0.
[[nodiscard]] inline option_row duration_row(const char* names, const char* help,
                                             std::chrono::nanoseconds& into) {
  return value_row(names, "TIME", help, into, duration_of);
}

/// A place in a recording, as nanoseconds from its beginning.
[[nodiscard]] inline option_row moment_row(const char* names, const char* help,
                                           std::int64_t& into) {
  return value_row(names, "TIME", help, into, moment_of);
}

template <class Target, class Value>
[[nodiscard]] option_row number_row(const char* names, std::string value, const char* help,
                                    Target& into, Value least, Value most) {
  return value_row(names, std::move(value), help, into,
                   [least, most](const std::string& word) { return number_of(word, least, most); });
}

/// --sample-rate: samples a second of raw bytes.
[[nodiscard]] inline option_row sample_rate_row(std::uint32_t& into) {
  return number_row("--sample-rate", "HZ", "Samples per second of raw bytes (9000)", into, 1U,
                    1'000'000U);
}

/// The kinds of fault of a simulated lidar.
[[nodiscard]] std::vector<std::string> fault_names();

/// One of a few words.
template <class Target, class Value>
[[nodiscard]] option_row choice_row(const char* names, const char* help, Target& into,
                                    const choices<Value>& known) {
  option_row row = value_row(names, words_of(known, "|"), help, into,
                             [known](const std::string& word) { return choice_of(word, known); });
  row.complete = completion::choices;
  return row;
}

/// `row`, and `check` is called with the word before it is taken.
[[nodiscard]] inline option_row checked(option_row row,
                                        std::function<void(const std::string&)> check) {
  row.take = [inner = std::move(row.take), is_valid = std::move(check)](const std::string& word) {
    is_valid(word);
    inner(word);
  };
  return row;
}

/// `rows` under a heading of the help.
[[nodiscard]] inline option_rows in_group(const char* heading, option_rows rows) {
  for (option_row& row : rows) row.group = heading;
  return rows;
}

/// Rows one after the other, each part an option_row or option_rows.
template <class... Parts>
[[nodiscard]] option_rows joined(Parts... parts) {
  option_rows all;
  const auto add = [&all](option_rows rows) {
    all.insert(all.end(), std::make_move_iterator(rows.begin()),
               std::make_move_iterator(rows.end()));
  };
  (add({std::move(parts)}), ...);
  return all;
}

}  // namespace g4_tool
