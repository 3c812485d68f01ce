// SPDX-License-Identifier: MIT
// Parses a world from text, line by line, or reports the error.
#include "sim/exact.hpp"

#include "g4lidar/sim/world.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "route.hpp"
#include "world_text.hpp"

namespace g4lidar::sim {
namespace {

double distance_m(const wall& w, const pose& viewpoint) noexcept {
  const double dx = w.x2_m - w.x1_m;
  const double dy = w.y2_m - w.y1_m;
  const double to_x = viewpoint.x_m - w.x1_m;
  const double to_y = viewpoint.y_m - w.y1_m;
  const double along = std::clamp((to_x * dx + to_y * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  const double x = to_x - along * dx;
  const double y = to_y - along * dy;
  return std::sqrt(x * x + y * y);
}

// Takes the lines of `text` in turn, until one is wrong.
template <class Take>
std::optional<world_error> each_line(std::string_view text, const Take& take) {
  for (std::size_t line_number = 1; !text.empty(); ++line_number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    line = line.substr(0, line.find('#'));
    const std::string_view word = next_word(line);
    if (!word.empty()) {
      if (auto wrong = take(word, line, line_number)) {
        return world_error{line_number, *std::move(wrong)};
      }
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return std::nullopt;
}

// Collects a world from lines.
class world_reader {
 public:
  // The error of the line, if any.
  std::optional<std::string> take(std::string_view word, std::string_view rest,
                                  std::size_t line_number) {
    if (word == "wall") return take_wall(rest, line_number);
    if (word == "disc") return take_disc(rest);
    if (word == "lidar") return take_lidar(rest);
    if (word == "mount") return take_mount(rest);
    if (auto taken = route_.take(word, rest, line_number)) return *std::move(taken);
    return quoted(word) +
           " is unknown; a line begins with 'wall', 'disc', 'lidar', 'mount', 'pose', 'drive' or "
           "'#'";
  }

  std::variant<world, world_error> finish() && {
    if (!has_lidar_ && !route_.has_poses()) {
      return world_error{0, "there is no line 'lidar x y heading_deg'"};
    }
    if (auto wrong = route_.finish(world_.lidar)) return *std::move(wrong);
    world_.path = std::move(route_).path();
    if (!world_.path.empty()) world_.lidar = world_.path.front().robot.at;
    const pose lidar = placed(world_.lidar, cable_pose(world_.mounted_at));
    for (std::size_t i = 0; i < world_.walls.size(); ++i) {
      if (distance_m(world_.walls[i], lidar) < min_clearance_m) {
        return world_error{line_of_wall_[i], "the wall is within 1 cm of the lidar"};
      }
    }
    return std::move(world_);
  }

 private:
  std::optional<std::string> take_wall(std::string_view rest, std::size_t line_number) {
    std::array<double, 4> at{};
    if (auto wrong = numbers(rest, at, "wall x1 y1 x2 y2")) return wrong;
    if (too_far(at)) return too_far_message;
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

  std::optional<std::string> take_disc(std::string_view rest) {
    std::array<double, 6> at{};
    auto read = read_numbers(rest, at, 3, "disc radius x y [to_x to_y speed]");
    if (read.wrong) return std::move(read.wrong);
    if (read.count == 4 || read.count == 5) {
      return "expected 'disc radius x y', or 'disc radius x y to_x to_y speed'";
    }
    if (too_far(std::span(at).subspan(1, 4))) return too_far_message;
    if (at[0] < min_disc_radius_m || at[0] > max_disc_radius_m) {
      return "the radius must be 0.01 to 2 m";
    }
    if (at[5] < 0.0 || at[5] > max_disc_speed_m_per_s) return "the speed must be 0 to 10 m/s";
    if (world_.discs.size() == max_discs) return "there are more than 1000 discs";
    world_.discs.push_back({at[0], at[1], at[2], at[3], at[4], at[5]});
    return std::nullopt;
  }

  // x, y and heading.
  static std::optional<std::string> read_pose(std::string_view rest, std::string_view form,
                                              pose& into) {
    std::array<double, 3> at{};
    if (auto wrong = numbers(rest, at, form)) return wrong;
    if (too_far(std::span(at).first(2))) return too_far_message;
    if (std::fabs(at[2]) > 360.0) return heading_message;
    into = {at[0], at[1], at[2]};
    return std::nullopt;
  }

  std::optional<std::string> take_lidar(std::string_view rest) {
    if (has_lidar_) return "there is a second lidar; a world has one";
    has_lidar_ = true;
    return read_pose(rest, "lidar x y heading_deg", world_.lidar);
  }

  // Worlds made before had the direction of the cable here, in a line without commas.
  static std::optional<std::string> old_mount(const std::string& first, std::string_view rest) {
    pose cable;
    const std::string line = first + std::string(rest);
    if (auto wrong = read_pose(line, "mount X,Y,DEG", cable)) return wrong;
    std::string_view words = rest;
    const std::string_view y = next_word(words);
    std::array<char, 32> looks{};
    const auto end = std::to_chars(looks.begin(), looks.end(), cable_pose(cable).heading_deg).ptr;
    return "'mount x y heading_deg' gave the direction of the cable. It is now where the lidar "
           "looks, as for "
           "--mount: write 'mount " +
           first + "," + std::string(y) + "," + std::string(looks.begin(), end) + "'";
  }

  std::optional<std::string> take_mount(std::string_view rest) {
    if (has_mount_) return "there is a second line 'mount'; a world has one lidar";
    has_mount_ = true;
    std::string place(next_word(rest));
    if (place.find(',') == std::string::npos) return old_mount(place, rest);
    if (place.ends_with(",down")) return "a simulated lidar cannot be mounted top down";
    if (!next_word(rest).empty())
      return "expected 'mount X,Y,DEG' without blanks between the numbers";
    std::replace(place.begin(), place.end(), ',', ' ');
    return read_pose(place, "mount X,Y,DEG", world_.mounted_at);
  }

  world world_;
  std::vector<std::size_t> line_of_wall_;
  route route_;
  bool has_lidar_ = false;
  bool has_mount_ = false;
};

}  // namespace

std::variant<world, world_error> parse_world(std::string_view text) {
  world_reader reader;
  const auto take = [&](auto... line) { return reader.take(line...); };
  if (auto wrong = each_line(text, take)) return *std::move(wrong);
  return std::move(reader).finish();
}

std::variant<std::vector<path_point>, world_error> parse_path(std::string_view text,
                                                              const pose& start) {
  route read;
  const auto take = [&](std::string_view word, std::string_view rest,
                        std::size_t line_number) -> std::optional<std::string> {
    if (auto taken = read.take(word, rest, line_number)) return *std::move(taken);
    return quoted(word) + " is unknown; a line of a path begins with 'pose', 'drive' or '#'";
  };
  if (auto wrong = each_line(text, take)) return *std::move(wrong);
  if (auto wrong = read.finish(start)) return *std::move(wrong);
  auto path = std::move(read).path();
  if (path.empty()) return world_error{0, "there is no line 'pose' and no line 'drive'"};
  return path;
}

}  // namespace g4lidar::sim
