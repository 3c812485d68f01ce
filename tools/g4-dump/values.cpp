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

std::chrono::nanoseconds moment_of(const std::string& text) {
  double number = -1.0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, number);
  if (error == std::errc() && number == 0.0) {
    const std::string one = "1" + std::string(at, end);
    static_cast<void>(duration_of(one));  // 0 of what?
    return std::chrono::nanoseconds(0);
  }
  return duration_of(text);
}

std::uint64_t byte_count_of(const std::string& text) {
  constexpr std::string_view steps = "kmgt";
  constexpr double most = 1e18;
  double number = 0.0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, number);
  std::string unit(at, end);
  for (char& letter : unit)
    letter = letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter + 32) : letter;
  double bytes = error == std::errc() && number >= 0.0 ? number : -1.0;
  if (!unit.empty()) {
    const std::size_t step = steps.find(unit.front());
    const std::string_view rest = std::string_view(unit).substr(1);
    const bool is_known =
        step != std::string_view::npos && (rest.empty() || rest == "ib" || rest == "b");
    const double factor = rest == "b" ? 1000.0 : 1024.0;
    for (std::size_t i = 0; is_known && i <= step; ++i) bytes *= factor;
    if (!is_known && unit != "b") bytes = -1.0;
  }
  if (bytes < 1.0 || bytes > most) {
    throw bad_value(fmt::format("'{}' is no size such as 500M or 1G", text));
  }
  return static_cast<std::uint64_t>(bytes);
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
