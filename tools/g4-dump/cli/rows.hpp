// SPDX-License-Identifier: MIT
// Makes rows of the table of options. Each writes into a value that exists as long as the table.
#pragma once

#include <cstdint>
#include <iterator>
#include <string>
#include <utility>

#include "values.hpp"
#include "verb.hpp"

namespace g4_dump {

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

}  // namespace g4_dump
