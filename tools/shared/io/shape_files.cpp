// SPDX-License-Identifier: MIT
#include "shape_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <variant>

#include "cli/exit_code.hpp"
#include "g4lidar/motion/odometry_feed.hpp"
#include "input.hpp"
#include "odometry_text.hpp"

namespace g4_tool {

namespace {

/// What `input` contains, at most so much. Throws a failure, or interrupted.
std::string text_of(input& input, std::size_t most_megabytes, const std::string& what_to_give) {
  std::string text;
  std::array<std::uint8_t, 16'384> part;
  while (const std::size_t count = input.read(part)) {
    text.append(reinterpret_cast<const char*>(part.data()), count);
    if (text.size() >> 20U >= most_megabytes) {
      throw failure(exit_code::bad_file, fmt::format("{} is longer than {} MB. {}", input.title(),
                                                     most_megabytes, what_to_give));
    }
  }
  if (interrupt() != 0) throw interrupted();
  return text;
}

/// The value of what was parsed. Throws a failure that names the file and the line.
template <class Value, class Error>
Value parsed(std::variant<Value, Error> made, const std::string& title,
             const std::string& what_to_give) {
  if (auto* const good = std::get_if<Value>(&made)) return std::move(*good);
  const Error& wrong = std::get<Error>(made);
  const std::string line = wrong.line > 0 ? fmt::format(", line {}", wrong.line) : "";
  throw failure(exit_code::bad_file,
                fmt::format("{}{}: {}. {}", title, line, wrong.message, what_to_give));
}

}  // namespace

g4lidar::mask mask_in(const std::string& path) {
  if (path == "-") {
    const std::string what_to_give = "Give lines 'polygon x1 y1 x2 y2 x3 y3 ...'.";
    input in(path, what_to_give);
    return parsed(g4lidar::parse_mask(text_of(in, 16, what_to_give)), "mask: " + in.title(),
                  what_to_give);
  }
  auto made = g4lidar::load_mask(path);
  if (auto* const good = std::get_if<g4lidar::mask>(&made)) return std::move(*good);
  throw failure(exit_code::bad_file, std::get<std::string>(made));
}

shaping_options shape_of(const common_options& options, const g4lidar::mask& loaded) {
  shaping_options made{.filter = directions_of(options),
                       .marks = options.marks,
                       .deskew = options.deskew,
                       .mount = options.mount.value_or(mounting{})};
  made.filter.masks = loaded.polygons();
  return made;
}

std::vector<stamped_pose> load_odometry(const std::string& path) {
  const std::string what_to_give = "Give a file with lines 'time_ns x y yaw_rad'.";
  input in(path, what_to_give);
  return parsed(parse_odometry(text_of(in, 1024, what_to_give)), in.title(), what_to_give);
}

std::vector<stamped_odometry> load_moving_odometry(const std::string& path) {
  std::vector<stamped_odometry> all;
  for (const stamped_pose& pose : load_odometry(path)) {
    twist_2d twist;
    if (!all.empty()) {
      const stamped_odometry& before = all.back();
      const double seconds = static_cast<double>(pose.time_ns - before.time_ns) * 1e-9;
      twist = twist_to(inverse(before.pose) * pose.pose, seconds);
    }
    all.push_back({pose.time_ns, pose.pose, twist});
  }
  return all;
}

std::vector<stamped_odometry> odometry_of_recording(const std::string& path) {
  auto all = g4lidar::recorded_odometry(path, [] { return interrupt() != 0; });
  if (!all && all.error() == problem::cancelled) throw interrupted();
  return value_of(std::move(all));
}

}  // namespace g4_tool
