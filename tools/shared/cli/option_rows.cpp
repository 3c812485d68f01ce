// SPDX-License-Identifier: MIT
#include "option_rows.hpp"

#include <algorithm>
#include <initializer_list>

namespace g4_tool {
namespace {

struct unit {
  std::string_view name;
  double factor;
};

/// The number in `text`, times the factor of its unit; below 0 if it has another form.
double scaled_number(std::string_view text, std::initializer_list<unit> units) {
  double number = 0.0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, number);
  const std::string_view name(at, static_cast<std::size_t>(end - at));
  const auto* const found = std::ranges::find(units, name, &unit::name);
  return error == std::errc() && found != units.end() ? number * found->factor : -1.0;
}

/// `text` as nanoseconds from `least` to ten years.
std::int64_t time_of(const std::string& text, double least) {
  constexpr double longest = 10 * 366 * 86400e9;
  const double ns = scaled_number(text, {{"", 1e9},
                                         {"ns", 1.0},
                                         {"us", 1e3},
                                         {"ms", 1e6},
                                         {"s", 1e9},
                                         {"min", 60e9},
                                         {"h", 3600e9},
                                         {"d", 86400e9}});
  if (ns >= least && ns <= longest) return static_cast<std::int64_t>(ns);
  throw bad_value(fmt::format(
      "'{}' is not a time such as 10s, 500ms or 2min, above 0 and at most 10 years", text));
}

/// The name in `text`, a word or limits, that is none of `known`.
std::string unknown_name(std::string_view text, const std::vector<std::string>& known) {
  while (!text.empty()) {
    const std::string_view piece = text.substr(0, text.find(','));
    text.remove_prefix(std::min(piece.size() + 1, text.size()));
    std::string name(piece.substr(0, piece.find('=')));
    if (std::ranges::find(known, name) == known.end()) return name;
  }
  return {};
}

/// The words that the option has on a command line.
std::vector<std::string> words_of(const g4lidar::parameter& of) {
  const auto words = of.words.first(of.words.size() - of.node_words);
  return {words.begin(), words.end()};
}

void refuse(const std::string& wrong, const g4lidar::parameter& parameter,
            const std::string& word) {
  if (wrong.empty()) return;
  const auto known = words_of(parameter);
  throw bad_value(wrong + did_you_mean(unknown_name(word, known), known));
}

}  // namespace

option_row row_of(const g4lidar::parameter& parameter,
                  std::function<void(const std::string&)> take) {
  option_row row{flag_of(parameter), std::string(parameter.form), std::string(parameter.text),
                 std::move(take)};
  const bool has_limits = row.value == "LIMITS";  // a flag, whose optional value sets some
  if (has_limits) row.optional_value = std::exchange(row.value, "");
  if (!has_limits && !parameter.words.empty()) {
    row.value = fmt::format("{}", fmt::join(words_of(parameter), "|"));
    row.complete = completion::choices;
  }
  if (row.value == "FILE") row.complete = completion::input;
  const std::string_view usual = parameter.unset.empty() ? parameter.usual : parameter.unset;
  if (!usual.empty() && usual != "off" && usual != "none") row.help += fmt::format(" ({})", usual);
  return row;
}

void store(g4lidar::lidar_options& into, const g4lidar::parameter& parameter,
           const std::string& word) {
  const bool is_flag = parameter.type == 1;
  refuse(set_option(into, parameter, is_flag ? g4lidar::parameter_value(true) : word), parameter,
         word);
}

void store(g4lidar::filter_settings& into, const g4lidar::parameter& parameter,
           const std::string& word) {
  refuse(set_filter(into, parameter.name, word), parameter, word);
}

std::size_t word_number(const g4lidar::parameter& parameter, const std::string& word) {
  const auto known = words_of(parameter);
  const auto at = std::ranges::find(known, word);
  if (at == known.end()) {
    refuse(fmt::format("'{}' is not one of {}", word, fmt::join(known, ", ")), parameter, word);
  }
  return static_cast<std::size_t>(at - known.begin());
}

std::chrono::nanoseconds duration_of(const std::string& text) {
  return std::chrono::nanoseconds(time_of(text, 1.0));
}

std::int64_t moment_of(const std::string& text) { return time_of(text, 0.0); }

std::uint64_t byte_count_of(const std::string& text) {
  constexpr double k = 1024.0;
  const double bytes = scaled_number(lowered(text), {{"", 1.0},
                                                     {"b", 1.0},
                                                     {"k", k},
                                                     {"kib", k},
                                                     {"kb", 1e3},
                                                     {"m", k * k},
                                                     {"mib", k * k},
                                                     {"mb", 1e6},
                                                     {"g", k * k * k},
                                                     {"gib", k * k * k},
                                                     {"gb", 1e9},
                                                     {"t", k * k * k * k},
                                                     {"tib", k * k * k * k},
                                                     {"tb", 1e12}});
  if (bytes >= 1.0 && bytes <= 1e18) return static_cast<std::uint64_t>(bytes);
  throw bad_value(fmt::format("'{}' is not a size such as 500M or 1G", text));
}

}  // namespace g4_tool
