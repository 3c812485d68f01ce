// SPDX-License-Identifier: MIT
// Parses a world from text, line by line, or reports the error.
#include "exact.hpp"

#include "g4lidar/sim/world.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace g4lidar::sim {
namespace {

constexpr bool is_space(char c) noexcept { return c == ' ' || c == '\t' || c == '\r'; }

// Takes the next word from the front of `line`; empty at its end.
std::string_view next_word(std::string_view& line) noexcept {
  while (!line.empty() && is_space(line.front())) line.remove_prefix(1);
  std::size_t end = 0;
  while (end < line.size() && !is_space(line[end])) ++end;
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(end);
  return word;
}

// A word for an error message, safe to print.
std::string quoted(std::string_view word) {
  constexpr std::size_t enough = 24;
  std::string out = "'";
  for (const char c : word.substr(0, enough)) out += c >= ' ' && c <= '~' ? c : '?';
  out += word.size() > enough ? "...'" : "'";
  return out;
}

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

// Parses as many numbers as `out` holds from the rest of a line; returns the error, if any.
std::optional<std::string> numbers(std::string_view rest, std::span<double> out,
                                   std::string_view form) {
  std::size_t count = 0;
  for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
    const std::optional<double> value = number(word);
    if (!value) {
      return quoted(word) + " is not a number; write decimals like -1.25, up to 15 digits";
    }
    if (count < out.size()) out[count] = *value;
    ++count;
  }
  if (count == out.size()) return std::nullopt;
  return "expected '" + std::string(form) + "', found " + std::to_string(count) +
         (count == 1 ? " number" : " numbers");
}

bool too_far(std::span<const double> coordinates) noexcept {
  return std::any_of(coordinates.begin(), coordinates.end(),
                     [](double x) { return std::fabs(x) > max_coordinate_m; });
}

double distance_m(const wall& w, const pose& from) noexcept {
  const double dx = w.x2_m - w.x1_m;
  const double dy = w.y2_m - w.y1_m;
  const double to_x = from.x_m - w.x1_m;
  const double to_y = from.y_m - w.y1_m;
  const double along = std::clamp((to_x * dx + to_y * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  const double x = to_x - along * dx;
  const double y = to_y - along * dy;
  return std::sqrt(x * x + y * y);
}

// Collects a world from lines.
class world_reader {
 public:
  // The error of the line, if any.
  std::optional<std::string> take(std::string_view line, std::size_t line_number) {
    line = line.substr(0, line.find('#'));
    const std::string_view word = next_word(line);
    if (word.empty()) return std::nullopt;
    if (word == "wall") return take_wall(line, line_number);
    if (word == "lidar") return take_lidar(line);
    return quoted(word) + " is unknown; a line begins with 'wall', 'lidar' or '#'";
  }

  std::variant<world, world_error> finish() && {
    if (!has_lidar_) return world_error{0, "there is no line 'lidar x y heading_deg'"};
    for (std::size_t i = 0; i < world_.walls.size(); ++i) {
      if (distance_m(world_.walls[i], world_.lidar) < min_clearance_m) {
        return world_error{line_of_wall_[i], "the wall is within 1 cm of the lidar"};
      }
    }
    return std::move(world_);
  }

 private:
  std::optional<std::string> take_wall(std::string_view rest, std::size_t line_number) {
    std::array<double, 4> at{};
    if (auto wrong = numbers(rest, at, "wall x1 y1 x2 y2")) return wrong;
    if (too_far(at)) return "no coordinate may be beyond 1000 m";
    const wall w{at[0], at[1], at[2], at[3]};
    const double dx = w.x2_m - w.x1_m;
    const double dy = w.y2_m - w.y1_m;
    if (std::sqrt(dx * dx + dy * dy) < min_wall_length_m) {
      return "the wall is shorter than 1 mm; coordinates are in metres";
    }
    if (world_.walls.size() == max_walls) return "there are more than 10000 walls";
    world_.walls.push_back(w);
    line_of_wall_.push_back(line_number);
    return std::nullopt;
  }

  std::optional<std::string> take_lidar(std::string_view rest) {
    std::array<double, 3> at{};
    if (auto wrong = numbers(rest, at, "lidar x y heading_deg")) return wrong;
    if (has_lidar_) return "there is a second lidar; a world has one";
    if (too_far(std::span(at).first(2))) return "no coordinate may be beyond 1000 m";
    if (std::fabs(at[2]) > 360.0) return "the heading must be -360 to 360 degrees";
    world_.lidar = {at[0], at[1], at[2]};
    has_lidar_ = true;
    return std::nullopt;
  }

  world world_;
  std::vector<std::size_t> line_of_wall_;
  bool has_lidar_ = false;
};

}  // namespace

std::variant<world, world_error> parse_world(std::string_view text) {
  world_reader reader;
  for (std::size_t line_number = 1; !text.empty(); ++line_number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    if (auto wrong = reader.take(text.substr(0, end), line_number)) {
      return world_error{line_number, *std::move(wrong)};
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return std::move(reader).finish();
}

}  // namespace g4lidar::sim
