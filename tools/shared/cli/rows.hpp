// SPDX-License-Identifier: MIT
// Makes rows of the table of options. Each row parses its value, throws bad_value for an invalid one,
// and writes into a variable that outlives the table.
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <ranges>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "suggestion.hpp"
#include "verbs.hpp"

namespace g4_tool {

/// The number that is all of `text`: 9000, 0.5, 1e3. Throws bad_value outside of `least` to `most`.
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

/// Words and their meanings, in the order of the help.
template <class Value>
using choices = std::vector<std::pair<std::string, Value>>;

/// The words, separated by `between`.
template <class Value>
[[nodiscard]] std::string words_of(const choices<Value>& known, std::string_view between) {
  return fmt::format("{}", fmt::join(known | std::views::keys, between));
}

/// The meaning of a word. The bad_value for an unknown word lists the known ones and the nearest one.
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

/// A position in a recording in nanoseconds: a duration, or 0.
[[nodiscard]] std::int64_t moment_of(const std::string& text);

/// "1G", "500M", "64k": multiples of 1024; "1GB": of 1000. A number alone: bytes.
[[nodiscard]] std::uint64_t byte_count_of(const std::string& text);

/// An option whose value `parse` converts; `parse` throws bad_value.
template <class Target, class Parse>
[[nodiscard]] option_row value_row(const char* names, std::string value, const char* help,
                                   Target& into, Parse parse) {
  return {names, std::move(value), help,
          [&into, convert = std::move(parse)](const std::string& word) { into = convert(word); }};
}

/// A flag that sets `into` to true.
[[nodiscard]] inline option_row flag_row(const char* names, const char* help, bool& into) {
  return value_row(names, "", help, into, [](const std::string&) { return true; });
}

template <class Target>
[[nodiscard]] option_row text_row(const char* names, std::string value, const char* help,
                                  Target& into, completion complete) {
  option_row row =
      value_row(names, std::move(value), help, into, [](const std::string& word) { return word; });
  row.complete = complete;
  return row;
}

/// A required argument: the name of a file.
[[nodiscard]] inline option_row file_argument(const char* name, const char* help, std::string& into,
                                              completion complete) {
  option_row row = text_row(name, "", help, into, complete);
  row.required = true;
  return row;
}

/// A time above 0.
[[nodiscard]] inline option_row duration_row(const char* names, const char* help,
                                             std::chrono::nanoseconds& into) {
  return value_row(names, "TIME", help, into, duration_of);
}

/// A position in a recording, as nanoseconds from its beginning.
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
[[nodiscard]] inline option_row sample_rate_row(std::optional<std::uint32_t>& into) {
  return number_row("--sample-rate", "HZ", "Samples per second of raw bytes (as the model)", into,
                    1U, 1'000'000U);
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

/// `row` with a `check` of each word before it is taken.
[[nodiscard]] inline option_row checked(option_row row,
                                        std::function<void(const std::string&)> check) {
  row.take = [inner = std::move(row.take), is_valid = std::move(check)](const std::string& word) {
    is_valid(word);
    inner(word);
  };
  return row;
}

/// `rows` with a heading in the help.
[[nodiscard]] inline option_rows in_group(const char* heading, option_rows rows) {
  for (option_row& row : rows) row.group = heading;
  return rows;
}

/// All rows in one table; each part is an option_row or option_rows.
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
