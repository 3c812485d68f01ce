// SPDX-License-Identifier: MIT
#include "g4lidar/export/odometry_text.hpp"

#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <system_error>
#include <utility>

#include "words.hpp"

namespace g4lidar {
namespace {

// The difference of two such times does not overflow: 146 years.
constexpr std::int64_t max_time_ns = std::int64_t{1} << 62U;

// Adds the pose of a line; returns the error, if any.
std::optional<std::string> read_pose(std::string_view line, std::vector<stamped_pose>& poses) {
  const std::string_view time = next_word(line);
  if (time.empty()) return std::nullopt;
  std::array<double, 3> values{};
  std::int64_t time_ns = 0;
  const char* const end = time.data() + time.size();
  const auto [at, wrong] = std::from_chars(time.data(), end, time_ns);
  if (wrong != std::errc() || at != end || time_ns >= max_time_ns || time_ns <= -max_time_ns) {
    return in_quotes(time) + " is not a time in whole nanoseconds; a line is 'time_ns x y yaw_rad'";
  }
  for (double& value : values) {
    const std::string_view word = next_word(line);
    const std::optional<double> read = number_in(word);
    if (word.empty()) return "there are less than the 4 numbers 'time_ns x y yaw_rad'";
    if (!read) return in_quotes(word) + " is not a number";
    if (*read < -max_odometry_value || *read > max_odometry_value) {
      return in_quotes(word) + " is above 1000000; x and y are in metres, yaw in radians";
    }
    value = *read;
  }
  if (!next_word(line).empty()) return "there are more than the 4 numbers 'time_ns x y yaw_rad'";
  if (!poses.empty() && time_ns <= poses.back().time_ns) {
    return in_quotes(time) + " is not later than the time of the pose before";
  }
  poses.push_back({time_ns, {values[0], values[1], values[2]}});
  return std::nullopt;
}

}  // namespace

std::variant<std::vector<stamped_pose>, odometry_error> parse_odometry(std::string_view text) {
  std::vector<stamped_pose> poses;
  for (std::size_t line_number = 1; !text.empty(); ++line_number) {
    if (auto wrong = read_pose(next_line(text), poses)) {
      return odometry_error{line_number, *std::move(wrong)};
    }
  }
  if (poses.empty()) return odometry_error{0, "there is no line 'time_ns x y yaw_rad'"};
  return poses;
}

}  // namespace g4lidar
