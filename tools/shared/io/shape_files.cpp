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
#include "g4lidar/export/odometry_text.hpp"
#include "input.hpp"

namespace g4_tool {
namespace {

/// What `parse` makes of the text in the file of that name: a variant of it and of an error with a
/// line. Throws a failure that names the file and the line. `what_to_give` ends its sentence.
template <class Made, class Parse>
Made load_text(const std::string& path, std::size_t most_megabytes, const std::string& what_to_give,
               Parse parse) {
  input in(path, what_to_give);
  std::string text;
  std::array<std::uint8_t, 16'384> part;
  while (const std::size_t count = in.read(part)) {
    text.append(reinterpret_cast<const char*>(part.data()), count);
    if (text.size() >> 20U >= most_megabytes) {
      throw failure(exit_code::bad_file, fmt::format("{} is longer than {} MB. {}", in.title(),
                                                     most_megabytes, what_to_give));
    }
  }
  auto made = parse(std::string_view(text));
  if (auto* const good = std::get_if<Made>(&made)) return std::move(*good);
  const auto& wrong = std::get<1>(made);
  const std::string line = wrong.line > 0 ? fmt::format(", line {}", wrong.line) : "";
  throw failure(exit_code::bad_file,
                fmt::format("{}{}: {}. {}", in.title(), line, wrong.message, what_to_give));
}

}  // namespace

g4lidar::mask load_mask(const std::string& path) {
  if (path.empty()) return {};
  return load_text<g4lidar::mask>(
      path, 16, "Give a file with lines 'polygon x1 y1 x2 y2 x3 y3 ...'.", g4lidar::parse_mask);
}

shaping_options shape_of(const common_options& how, const g4lidar::mask& loaded) {
  shaping_options made{.filter = how.filter,
                       .marks = how.marks,
                       .deskew = how.deskew,
                       .mount = how.mount.value_or(mounting{})};
  made.filter.in = how.frame;
  made.filter.ignored_sectors = how.ignored;
  made.filter.masks = loaded.polygons();
  return made;
}

std::vector<stamped_pose> load_odometry(const std::string& path) {
  return load_text<std::vector<stamped_pose>>(
      path, 1024, "Give a file with lines 'time_ns x y yaw_rad'.", g4lidar::parse_odometry);
}

std::vector<stamped_odometry> recorded_odometry(const std::string& path) {
  std::vector<stamped_odometry> all;
  read_items(path, {}, [&all](const recorded_item& item) {
    if (item.what == recorded_item::kind::odometry) all.push_back(item.odometry);
    return true;
  });
  std::ranges::sort(all, {}, &stamped_odometry::time_ns);
  const auto same = std::ranges::unique(all, {}, &stamped_odometry::time_ns);
  all.erase(same.begin(), same.end());
  return all;
}

}  // namespace g4_tool
