// SPDX-License-Identifier: MIT
#include "values.hpp"

#include <array>
#include <string_view>
#include <utility>

namespace g4_dump {

std::uint64_t whole_number_of(const std::string& text) {
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, value);
  if (error == std::errc() && at == end) return value;
  throw bad_value(fmt::format("'{}' is no whole number from 0 to {}", text, UINT64_MAX));
}

std::chrono::nanoseconds duration_of(const std::string& text) {
  constexpr std::array<std::pair<std::string_view, double>, 8> units{{{"", 1e9},
                                                                      {"ns", 1.0},
                                                                      {"us", 1e3},
                                                                      {"ms", 1e6},
                                                                      {"s", 1e9},
                                                                      {"min", 60e9},
                                                                      {"h", 3600e9},
                                                                      {"d", 86400e9}}};
  constexpr double longest_ns = 10 * 366 * 86400e9;
  double number = 0.0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, number);
  if (error == std::errc()) {
    const std::string_view unit(at, static_cast<std::size_t>(end - at));
    for (const auto& [name, ns] : units) {
      const double all_ns = number * ns;
      if (unit == name && all_ns >= 1.0 && all_ns <= longest_ns) {
        return std::chrono::nanoseconds(static_cast<std::int64_t>(all_ns));
      }
    }
  }
  throw bad_value(fmt::format(
      "'{}' is no time such as 10s, 500ms or 2min, above 0 and at most 10 years", text));
}

number_range range_of(const std::string& text, double least, double most) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    throw bad_value(fmt::format("'{}' is no range such as {}:{}", text, least, most));
  }
  const std::string from = text.substr(0, colon);
  const std::string to = text.substr(colon + 1);
  return {from.empty() ? least : number_of(from, least, most),
          to.empty() ? most : number_of(to, least, most)};
}

}  // namespace g4_dump
