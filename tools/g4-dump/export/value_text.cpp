// SPDX-License-Identifier: MIT
#include "value_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include <fmt/format.h>

namespace g4_tool {
namespace {

template <class Number>
std::string in_words(Number number) {
  std::array<char, 32> text;
  const auto done =
      std::to_chars(text.data(), text.data() + text.size(), number, std::chars_format::general);
  return {text.data(), done.ptr};
}

}  // namespace

char* put_seconds(char* out, std::int64_t time_ns) noexcept {
  const bool is_negative = time_ns < 0;
  const auto number = static_cast<std::uint64_t>(time_ns);
  const std::uint64_t magnitude = is_negative ? std::uint64_t{0} - number : number;
  if (is_negative) *out++ = '-';
  return digits::put_scaled<6>(out, magnitude / 1'000U);
}

std::string with_decimals(double number, int decimals) {
  return fmt::format("{:.{}f}", number, decimals);
}

std::string shortest(double number) { return in_words(number); }
std::string shortest(float number) { return in_words(number); }

std::string if_known(double number, int decimals, const char* unknown) {
  return number > 0.0 ? with_decimals(number, decimals) : unknown;
}

std::string in_column(std::size_t width, const std::string& text) {
  return std::string(width - std::min(width, text.size()), ' ') + text;
}

std::size_t returns_in(std::span<const point> points) noexcept {
  return points.size() -
         static_cast<std::size_t>(std::ranges::count_if(points, &point::is_no_return));
}

std::string names_of(scan_flags flags, std::string_view before, std::string_view between,
                     std::string_view after) {
  using enum scan_flags;
  constexpr std::array<std::pair<scan_flags, std::string_view>, 7> names{
      {{start_missing, "start_missing"},
       {end_missing, "end_missing"},
       {data_lost, "data_lost"},
       {turn_short, "turn_short"},
       {start_by_angle, "start_by_angle"},
       {end_by_angle, "end_by_angle"},
       {crc_mismatch, "crc_mismatch"}}};
  std::string text;
  for (const auto& [flag, name] : names) {
    if ((flags & flag) == none) continue;
    if (!text.empty()) text += between;
    text.append(before).append(name).append(after);
  }
  return text;
}

}  // namespace g4_tool
