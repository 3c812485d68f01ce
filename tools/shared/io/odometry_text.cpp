// SPDX-License-Identifier: MIT
#include "odometry_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <system_error>
#include <utility>

#include "cli/logger.hpp"

namespace g4_tool {
namespace {

// The difference of two such times does not overflow: 146 years.
constexpr std::int64_t max_time_ns = std::int64_t{1} << 62U;

/// The words of a line before its comment; those behind the fifth one are left out, and what is missing is empty.
using line_words = std::array<std::string_view, 5>;
line_words words_of(std::string_view line) {
  constexpr std::string_view spaces = " \t\r";
  line = line.substr(0, line.find('#'));
  line_words words{};
  for (std::string_view& word : words) {
    line.remove_prefix(std::min(line.find_first_not_of(spaces), line.size()));
    word = line.substr(0, line.find_first_of(spaces));
    line.remove_prefix(word.size());
  }
  return words;
}

/// A finite number that is the whole word; it may have a plus sign.
std::optional<double> finite_number(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  double value = 0.0;
  const char* const end = word.data() + word.size();
  const auto [at, wrong] = std::from_chars(word.data(), end, value);
  if (wrong != std::errc() || at != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// A word in a message, and not more than its begin.
std::string shown(std::string_view word) {
  constexpr std::size_t enough = 40;
  return in_quotes(printable(word.substr(0, enough)) + (word.size() > enough ? "..." : ""));
}

// Adds the pose of a line; returns the error, if any.
std::optional<std::string> read_pose(std::string_view line, std::vector<stamped_pose>& poses) {
  const line_words words = words_of(line);
  const std::string_view time = words[0];
  if (time.empty()) return std::nullopt;
  std::array<double, 3> values{};
  std::int64_t time_ns = 0;
  const char* const end = time.data() + time.size();
  const auto [at, wrong] = std::from_chars(time.data(), end, time_ns);
  if (wrong != std::errc() || at != end || time_ns >= max_time_ns || time_ns <= -max_time_ns) {
    return shown(time) + " is not a time in whole nanoseconds; a line is 'time_ns x y yaw_rad'";
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string_view word = words[i + 1];
    const std::optional<double> read = finite_number(word);
    if (word.empty()) return "there are less than the 4 numbers 'time_ns x y yaw_rad'";
    if (!read) return shown(word) + " is not a number";
    if (*read < -max_odometry_value || *read > max_odometry_value) {
      return shown(word) + " is above 1000000; x and y are in metres, yaw in radians";
    }
    values[i] = *read;
  }
  if (!words[4].empty()) return "there are more than the 4 numbers 'time_ns x y yaw_rad'";
  if (!poses.empty() && time_ns <= poses.back().time_ns) {
    return shown(time) + " is not later than the time of the pose before";
  }
  poses.push_back({time_ns, {values[0], values[1], values[2]}});
  return std::nullopt;
}

}  // namespace

std::variant<std::vector<stamped_pose>, odometry_error> parse_odometry(std::string_view text) {
  std::vector<stamped_pose> poses;
  for (std::size_t line_number = 1; !text.empty(); ++line_number) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (auto wrong = read_pose(line, poses)) return odometry_error{line_number, *std::move(wrong)};
  }
  if (poses.empty()) return odometry_error{0, "there is no line 'time_ns x y yaw_rad'"};
  return poses;
}

}  // namespace g4_tool
