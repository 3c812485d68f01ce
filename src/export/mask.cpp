// SPDX-License-Identifier: MIT
#include "g4lidar/export/mask.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

#include "words.hpp"

namespace g4lidar {
namespace {

constexpr std::size_t most_bytes = std::size_t{16} << 20U;

/// The contents of a file, or why they cannot be read.
std::variant<std::string, std::errc> text_in(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rbe"),
                                                             std::fclose);
  if (!file) return std::errc{errno};
  std::string text;
  std::array<char, 16'384> part;
  while (const std::size_t count = std::fread(part.data(), 1, part.size(), file.get())) {
    text.append(part.data(), count);
    if (text.size() > most_bytes) return std::errc::file_too_large;
  }
  if (std::ferror(file.get()) != 0) return std::errc{errno};
  return text;
}

// Whether all corners are on one line: then nothing is inside.
bool has_no_area(const std::vector<corner>& corners) noexcept {
  const corner& first = corners.front();
  const auto is_other = [&first](const corner& c) { return c != first; };
  const auto second = std::find_if(corners.begin(), corners.end(), is_other);
  if (second == corners.end()) return true;
  const auto off_line = [&](const corner& c) {
    return (second->x_m - first.x_m) * (c.y_m - first.y_m) !=
           (second->y_m - first.y_m) * (c.x_m - first.x_m);
  };
  return std::none_of(corners.begin(), corners.end(), off_line);
}

// Reads the corners of a polygon; returns the error, if any.
std::optional<std::string> read_corners(std::string_view rest, std::vector<corner>& corners) {
  std::size_t count = 0;
  for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
    const std::optional<double> value = number_in(word, std::chars_format::fixed);
    if (!value) return quoted(word) + " is not a number; write decimals like -0.25";
    if (!(*value >= -max_mask_coordinate_m && *value <= max_mask_coordinate_m)) {
      return "no coordinate may be beyond 100 m; coordinates are in metres";
    }
    if (count % 2 == 0) corners.emplace_back();
    (count % 2 == 0 ? corners.back().x_m : corners.back().y_m) = static_cast<float>(*value);
    if (++count > 2 * max_mask_corners) return "there are more than 1000 corners";
  }
  if (count % 2 != 0 || count < 6) {
    return "expected 'polygon x1 y1 x2 y2 x3 y3 ...', found " + std::to_string(count) +
           (count == 1 ? " number" : " numbers");
  }
  if (has_no_area(corners)) return "all corners are on one line";
  return std::nullopt;
}

// Adds what a line contains; returns the error, if any.
std::optional<std::string> read_line(std::string_view line, mask& made) {
  const std::string_view word = next_word(line);
  if (word.empty()) return std::nullopt;
  if (word != "polygon") return quoted(word) + " is unknown; a line begins with 'polygon' or '#'";
  if (made.polygons().size() == max_mask_polygons) return "there are more than 1000 polygons";
  std::vector<corner> corners;
  if (auto wrong = read_corners(line, corners)) return wrong;
  made.add(std::move(corners));
  return std::nullopt;
}

}  // namespace

std::variant<mask, mask_error> parse_mask(std::string_view text) {
  mask made;
  for (std::size_t line_number = 1; !text.empty(); ++line_number) {
    if (auto wrong = read_line(next_line(text), made)) {
      return mask_error{line_number, *std::move(wrong)};
    }
  }
  if (made.polygons().empty()) return mask_error{0, "there is no line 'polygon x1 y1 x2 y2 x3 y3'"};
  return made;
}

std::variant<mask, std::string> load_mask(const std::string& path) {
  if (path.empty()) return mask();
  const std::string title = "mask: '" + printable(path) + "'";
  const std::string advice = ". Give a file with lines 'polygon x1 y1 x2 y2 x3 y3 ...'.";
  const auto text = text_in(path);
  if (const auto* wrong = std::get_if<std::errc>(&text)) {
    const std::string why = *wrong == std::errc::is_a_directory ? " is a directory"
                            : *wrong == std::errc::file_too_large
                                ? " is longer than 16 MB"
                                : " cannot be read: " + std::make_error_code(*wrong).message();
    return title + why + advice;
  }
  auto made = parse_mask(std::get<std::string>(text));
  if (auto* const good = std::get_if<mask>(&made)) return std::move(*good);
  const mask_error& wrong = std::get<mask_error>(made);
  const std::string line = wrong.line > 0 ? ", line " + std::to_string(wrong.line) : "";
  return title + line + ": " + wrong.message + advice;
}

}  // namespace g4lidar
