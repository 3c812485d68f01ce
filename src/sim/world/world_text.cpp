// SPDX-License-Identifier: MIT
#include "sim/exact.hpp"

#include "world_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "g4lidar/sim/world.hpp"

namespace g4lidar::sim {
namespace {

constexpr bool is_space(char c) noexcept { return c == ' ' || c == '\t' || c == '\r'; }

// [+-]digits[.digits], at most 15 significant digits and 15 behind the point: an integer and a
// power of ten are then both exact, and one division rounds like a correct conversion, in any
// locale.
std::optional<double> number(std::string_view word) noexcept {
  const bool negative = !word.empty() && word.front() == '-';
  if (!word.empty() && (word.front() == '-' || word.front() == '+')) word.remove_prefix(1);
  std::int64_t digits = 0;
  double scale = 1.0;
  bool any = false;
  bool behind_point = false;
  for (const char c : word) {
    if (c == '.' && !behind_point) {
      behind_point = true;
      continue;
    }
    if (c < '0' || c > '9') return std::nullopt;
    any = true;
    digits = digits * 10 + (c - '0');
    if (behind_point) scale *= 10.0;
    if (digits >= 1'000'000'000'000'000 || scale > 1e15) return std::nullopt;
  }
  if (!any) return std::nullopt;
  const double value = static_cast<double>(digits) / scale;
  return negative ? -value : value;
}

}  // namespace

std::string_view next_word(std::string_view& line) noexcept {
  while (!line.empty() && is_space(line.front())) line.remove_prefix(1);
  std::size_t end = 0;
  while (end < line.size() && !is_space(line[end])) ++end;
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(end);
  return word;
}

std::string quoted(std::string_view word, std::size_t enough) {
  std::string out = "'";
  for (const char c : word.substr(0, enough)) out += c >= ' ' && c <= '~' ? c : '?';
  out += word.size() > enough ? "...'" : "'";
  return out;
}

numbers_read read_numbers(std::string_view rest, std::span<double> out, std::size_t least,
                          std::string_view form) {
  std::size_t count = 0;
  for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
    const std::optional<double> value = number(word);
    if (!value) {
      return {0, quoted(word) + " is not a number; write decimals like -1.25, up to 15 digits"};
    }
    if (count < out.size()) out[count] = *value;
    ++count;
  }
  if (count >= least && count <= out.size()) return {count, std::nullopt};
  return {0, "expected '" + std::string(form) + "', found " + std::to_string(count) +
                 (count == 1 ? " number" : " numbers")};
}

std::optional<std::string> numbers(std::string_view rest, std::span<double> out,
                                   std::string_view form) {
  return read_numbers(rest, out, out.size(), form).wrong;
}

bool too_far(std::span<const double> coordinates) noexcept {
  return std::any_of(coordinates.begin(), coordinates.end(),
                     [](double x) { return std::fabs(x) > max_coordinate_m; });
}

}  // namespace g4lidar::sim
