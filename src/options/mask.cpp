// SPDX-License-Identifier: MIT
#include "g4lidar/options/filter_text.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

#include "g4lidar/error.hpp"
#include "text_words.hpp"
#include "transport/text_file.hpp"

namespace g4lidar {
namespace {

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
    if (!value) return in_quotes(word) + " is not a number; write decimals like -0.25";
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
  if (word != "polygon")
    return in_quotes(word) + " is unknown; a line begins with 'polygon' or '#'";
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
  const std::string title = "mask: " + in_quotes(path);
  const std::string advice = ". Give a file with lines 'polygon x1 y1 x2 y2 x3 y3 ...'.";
  std::string text;
  if (const std::string why = read_text_file(path, text); !why.empty())
    return std::string(title).append(" ").append(why).append(advice);
  auto made = parse_mask(text);
  if (auto* const good = std::get_if<mask>(&made)) return std::move(*good);
  const mask_error& wrong = std::get<mask_error>(made);
  const std::string line = wrong.line > 0 ? ", line " + std::to_string(wrong.line) : "";
  return title + line + ": " + wrong.message + advice;
}

}  // namespace g4lidar
