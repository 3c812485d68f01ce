// SPDX-License-Identifier: MIT
#include "g4lidar/filter_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>

#include "core/number_text.hpp"

namespace g4lidar {
namespace {

constexpr std::array<std::string_view, 3> no_return_words{"inf", "nan", "max"};
constexpr std::array<std::string_view, 2> near_as_words{"nan", "minus-inf"};
constexpr std::array<std::string_view, 4> speckle_words{"window", "count", "near", "ratio"};
constexpr std::array<std::string_view, 2> edge_words{"window", "angle"};
constexpr std::array<std::string_view, 2> near_words{"shortest", "revolutions"};

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

/// A limit of marks, and where its value goes.
struct named_limit {
  double least;
  double most;
  bool is_whole;
  std::function<void(double)> take;
};

/// "window=2,count=1": those of `limits`, in the order of `names`. Returns why not, or nothing.
std::string take_limits(std::string_view text, std::span<const std::string_view> names,
                        std::span<const named_limit> limits) {
  while (!text.empty()) {
    const std::string_view piece = text.substr(0, text.find(','));
    text.remove_prefix(std::min(piece.size() + 1, text.size()));
    const std::size_t equals = std::min(piece.find('='), piece.size());
    const auto found = std::ranges::find(names, piece.substr(0, equals));
    if (found == names.end() || equals == piece.size())
      return in_quotes(piece) + " is not one of " +
             list_of(names, [](std::string_view name) { return std::string(name) + "=N"; });
    const named_limit& limit = limits[static_cast<std::size_t>(found - names.begin())];
    const auto value = number_in(piece.substr(equals + 1), limit.least, limit.most);
    if (!value) return value.error();
    if (limit.is_whole && *value != std::floor(*value))
      return in_quotes(piece) + " is not a whole number";
    limit.take(*value);
  }
  return {};
}

/// Stores a number, times `factor`, in a member of limits.
template <class Member>
std::function<void(double)> store_in(Member& into, double factor = 1.0) {
  return [&into, factor](double value) { into = static_cast<Member>(value * factor); };
}

std::string set_speckle(std::optional<speckle_limits>& into, std::string_view text) {
  speckle_limits made;
  const std::array<named_limit, 4> limits{{{1, max_window, true, store_in(made.window)},
                                           {1, 2 * max_window, true, store_in(made.count)},
                                           {0, 100, false, store_in(made.near_m)},
                                           {0, 1, false, store_in(made.near_ratio)}}};
  std::string wrong = take_limits(text, speckle_words, limits);
  if (wrong.empty()) into = made;
  return wrong;
}

std::string set_edges(std::optional<edge_limits>& into, std::string_view text) {
  edge_limits made;
  const std::array<named_limit, 2> limits{{{1, max_window, true, store_in(made.window)},
                                           {0.1, 45, false, store_in(made.least_angle_deg)}}};
  std::string wrong = take_limits(text, edge_words, limits);
  if (wrong.empty()) into = made;
  return wrong;
}

std::string set_near(std::optional<near_limits>& into, std::string_view text) {
  near_limits made;
  const std::array<named_limit, 2> limits{{{0.01, 16, false, store_in(made.shortest_mm, 1e3)},
                                           {0, 1e9, true, store_in(made.revolutions)}}};
  std::string wrong = take_limits(text, near_words, limits);
  if (wrong.empty()) into = made;
  return wrong;
}

std::string set_marks(mark_limits& into, std::string_view name, std::string_view text) {
  if (text == "off") {
    if (name == "speckle") into.speckle.reset();
    if (name == "edges") into.edges.reset();
    if (name == "near") into.near.reset();
    return {};
  }
  if (text == "on") text = {};
  if (name == "speckle") return set_speckle(into.speckle, text);
  if (name == "edges") return set_edges(into.edges, text);
  return set_near(into.near, text);
}

std::string set_range(point_filter& into, std::string_view text) {
  const auto range = range_in(text, 0.0, 100.0);
  if (!range) return range.error();
  if (range->to < range->from) return in_quotes(text) + " ends before it begins";
  // Rounded to a thousandth of a millimetre, so that 0.28 is 280.
  into.least_range_mm = static_cast<float>(std::round(range->from * 1e6) / 1e3);
  into.greatest_range_mm = static_cast<float>(std::round(range->to * 1e6) / 1e3);
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
  if (name == "speckle") return speckle_words;
  if (name == "edges") return edge_words;
  if (name == "near") return near_words;
  if (name == "no_return") return no_return_words;
  if (name == "near_as") return near_as_words;
  return {};
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
  if (name == "ignore") return set_ignored(into.ignored, text);
  if (name == "fov") {
    const auto one = sector_in(text);
    if (one) into.filter.field_of_view = *one;
    return one ? "" : one.error();
  }
  if (name == "speckle" || name == "edges" || name == "near")
    return set_marks(into.marks, name, text);
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
