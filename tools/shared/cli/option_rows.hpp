// SPDX-License-Identifier: MIT
// Makes rows of the table of options. Each row parses its value, throws bad_value for an invalid one,
// and writes into a variable that outlives the table.
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <ranges>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

#include "g4lidar/options/filter_text.hpp"
#include "g4lidar/options/option_table.hpp"
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

/// The row of an option of the table of the library, with its name, value and text.
[[nodiscard]] option_row row_of(const g4lidar::parameter& parameter,
                                std::function<void(const std::string&)> take);

// How a word is stored, as the option of the table states. Each throws bad_value.
void store(g4lidar::lidar_options& into, const g4lidar::parameter& parameter,
           const std::string& word);
void store(g4lidar::filter_settings& into, const g4lidar::parameter& parameter,
           const std::string& word);
/// The number of the word among those of the option.
[[nodiscard]] std::size_t word_number(const g4lidar::parameter& parameter, const std::string& word);
template <class Target>
void store(Target& into, const g4lidar::parameter& parameter, const std::string& word) {
  if constexpr (std::is_same_v<Target, bool>)
    into = true;
  else if constexpr (std::is_enum_v<Target>)
    into = static_cast<Target>(word_number(parameter, word));
  else if constexpr (std::is_arithmetic_v<Target>)
    into = number_of(word, static_cast<Target>(parameter.range[0]),
                     static_cast<Target>(parameter.range[1]));
  else
    into = word;
}
template <class Value>
void store(std::optional<Value>& into, const g4lidar::parameter& parameter,
           const std::string& word) {
  Value made{};
  store(made, parameter, word);
  into = made;
}

/// The row of an option of the table, whose value is stored in `into`.
template <class Target>
[[nodiscard]] option_row row_of(std::string_view name, Target& into) {
  const g4lidar::parameter& of = *g4lidar::find_parameter(name);
  return row_of(of, [&into, &of](const std::string& word) { store(into, of, word); });
}
/// Those of several, with a heading in the help.
template <class Target>
[[nodiscard]] option_rows rows_of(const char* heading, std::initializer_list<const char*> names,
                                  Target& into) {
  option_rows rows;
  for (const char* const name : names) rows.push_back(row_of(name, into));
  for (option_row& row : rows) row.group = heading;
  return rows;
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
