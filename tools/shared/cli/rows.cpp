// SPDX-License-Identifier: MIT
#include "rows.hpp"

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

}  // namespace

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
