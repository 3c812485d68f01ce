// SPDX-License-Identifier: MIT
#include "g4lidar/options/filter_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

#include "core/number_text.hpp"
#include "g4lidar/options/option_table.hpp"

namespace g4lidar {
namespace {

struct span_of_numbers {
  double from;
  double to;
};

/// "FROM:TO", either of which may be missing.
text_result<span_of_numbers> range_in(std::string_view text, double least, double most) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) {
    return tl::unexpected(in_quotes(text) + " is not a range such as " + text_of_number(least) +
                          ":" + text_of_number(most));
  }
  span_of_numbers made{least, most};
  for (const auto& [part, into] : {std::pair{text.substr(0, colon), &made.from},
                                   std::pair{text.substr(colon + 1), &made.to}}) {
    if (part.empty()) continue;
    const auto number = number_in(part, least, most);
    if (!number) return tl::unexpected(number.error());
    *into = *number;
  }
  return made;
}

text_result<sector> sector_in(std::string_view text) {
  const auto range = range_in(text, -360.0, 360.0);
  if (!range) return tl::unexpected(range.error());
  return sector(range->from, range->to);
}

/// A limit of a mark, in the order of the words of its parameter.
struct mark_limit {
  double least;
  double most;
  bool is_whole;
  void (*take)(mark_limits& into, double value);
};
constexpr std::array<mark_limit, 4> limits_of_speckle{{
    {1, max_window, true, [](auto& marks, double n) { marks.speckle->window = std::size_t(n); }},
    {1, 2 * max_window, true, [](auto& marks, double n) { marks.speckle->count = std::size_t(n); }},
    {0, 100, false, [](auto& marks, double m) { marks.speckle->near_m = float(m); }},
    {0, 1, false, [](auto& marks, double ratio) { marks.speckle->near_ratio = float(ratio); }},
}};
constexpr std::array<mark_limit, 2> limits_of_edges{{
    {1, max_window, true, [](auto& marks, double n) { marks.edges->window = std::size_t(n); }},
    {0.1, 45, false, [](auto& marks, double deg) { marks.edges->least_angle_deg = float(deg); }},
}};
constexpr std::array<mark_limit, 2> limits_of_near{{
    {0.01, 16, false, [](auto& marks, double m) { marks.near->shortest_mm = float(m * 1e3); }},
    {0, 1e9, true, [](auto& marks, double n) { marks.near->revolutions = std::uint32_t(n); }},
}};

/// "off", "on" or nothing, or limits: "window=2,count=1". Returns why not, or nothing.
template <class Limits>
std::string set_mark(filter_settings& into, std::string_view name, std::string_view text,
                     std::optional<Limits> mark_limits::* mark,
                     std::span<const mark_limit> limits) {
  mark_limits made = into.marks;
  (made.*mark).reset();
  if (text != "off") (made.*mark).emplace();
  if (text == "off" || text == "on") text = {};
  const auto names = filter_words(name);
  while (!text.empty()) {
    const std::string_view piece = text.substr(0, text.find(','));
    text.remove_prefix(std::min(piece.size() + 1, text.size()));
    const std::size_t equals = std::min(piece.find('='), piece.size());
    const auto found = std::ranges::find(names, piece.substr(0, equals));
    if (found == names.end() || equals == piece.size())
      return in_quotes(piece) + " is not one of " +
             list_of(names, [](std::string_view each) { return std::string(each) + "=N"; });
    const mark_limit& limit = limits[static_cast<std::size_t>(found - names.begin())];
    const auto value = number_in(piece.substr(equals + 1), limit.least, limit.most);
    if (!value) return value.error();
    if (limit.is_whole && *value != std::floor(*value))
      return in_quotes(piece) + " is not a whole number";
    limit.take(made, *value);
  }
  into.marks = made;
  return {};
}

/// Rounded to a thousandth of a millimetre, so that 0.28 is 280.
float in_mm(double metres) { return static_cast<float>(std::round(metres * 1e6) / 1e3); }

std::string set_range(point_filter& into, std::string_view text) {
  const auto range = range_in(text, 0.0, 100.0);
  if (!range) return range.error();
  if (range->to < range->from) return in_quotes(text) + " ends before it begins";
  into.least_range_mm = in_mm(range->from);
  into.greatest_range_mm = in_mm(range->to);
  return {};
}

std::string set_ignored(std::vector<sector>& into, std::string_view text) {
  std::vector<sector> made;
  if (text == "off") text = {};
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(word.size() + 1, text.size()));
    if (word.empty()) continue;
    const auto one = sector_in(word);
    if (!one) return one.error();
    made.push_back(*one);
  }
  into = std::move(made);
  return {};
}

}  // namespace

std::span<const std::string_view> filter_words(std::string_view name) noexcept {
  const parameter* const known = find_parameter(name);
  const bool is_filter = known != nullptr && known->kind == parameter_kind::filter;
  return is_filter ? known->words : std::span<const std::string_view>();
}

std::variant<mounting, std::string> mounting_in(std::string_view text) {
  constexpr std::string_view down = ",down";
  const bool is_down = text.ends_with(down);
  const std::string_view place = text.substr(0, text.size() - (is_down ? down.size() : 0));
  const std::size_t first = place.find(',');
  const std::size_t second = std::min(place.find(',', first + 1), place.size());
  if (first == std::string_view::npos || second == place.size())
    return in_quotes(text) + " is not a place such as 0.1,0,180 (m, m, degrees)";
  const auto x = number_in(place.substr(0, first), -100.0, 100.0);
  const auto y = number_in(place.substr(first + 1, second - first - 1), -100.0, 100.0);
  const auto yaw_deg = number_in(place.substr(second + 1), -360.0, 360.0);
  for (const auto* each : {&yaw_deg, &x, &y}) {
    if (!*each) return each->error();
  }
  return mounting{{*x, *y, *yaw_deg * std::numbers::pi / 180.0}, is_down};
}

std::string set_filter(filter_settings& into, std::string_view name, std::string_view text) {
  if (name == "range") return set_range(into.filter, text);
  if (name == "range_min" || name == "range_max") {
    const auto metres = number_in(text, 0.0, 100.0);
    if (!metres) return metres.error();
    (name == "range_min" ? into.filter.least_range_mm : into.filter.greatest_range_mm) =
        in_mm(*metres);
    return {};
  }
  if (name == "ignore") return set_ignored(into.ignored, text);
  if (name == "fov") {
    const auto one = sector_in(text);
    if (one) into.filter.field_of_view = *one;
    return one ? "" : one.error();
  }
  if (name == "speckle")
    return set_mark(into, name, text, &mark_limits::speckle, limits_of_speckle);
  if (name == "edges") return set_mark(into, name, text, &mark_limits::edges, limits_of_edges);
  if (name == "near") return set_mark(into, name, text, &mark_limits::near, limits_of_near);
  const auto words = filter_words(name);
  const auto at = std::ranges::find(words, text);
  if (words.empty()) return "there is no filter " + in_quotes(name);
  if (at == words.end()) return in_quotes(text) + " is not one of " + list_of(words);
  const auto index = at - words.begin();
  if (name == "no_return") into.grid.no_return = static_cast<no_return_as>(index);
  if (name == "near_as") into.grid.near_is_minus_infinity = index == 1;
  return {};
}

}  // namespace g4lidar
