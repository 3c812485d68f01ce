// SPDX-License-Identifier: MIT
#include "text_points.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <system_error>
#include <utility>

#include "g4lidar/scan.hpp"

namespace g4_tool {
namespace {

/// The complete `text` as a number.
template <class Value>
bool read_number(std::string_view text, Value& value) {
  const char* const begin = text.data();
  const char* const end = begin + text.size();
  const auto [at, error] = std::from_chars(begin, end, value);
  return error == std::errc() && at == end;
}

/// The same; no text leaves `value` as it is.
template <class Value>
bool read_if_any(std::string_view text, Value& value) {
  return text.empty() || read_number(text, value);
}

/// Passes the number of each field of a csv line, from 0 on, and the field.
template <class Take>
void for_each_field(std::string_view line, Take take) {
  constexpr std::size_t most = 1000;
  for (std::size_t column = 0; column < most; ++column) {
    const std::size_t comma = std::min(line.find(','), line.size());
    take(column, line.substr(0, comma));
    if (comma == line.size()) return;
    line.remove_prefix(comma + 1);
  }
}

/// "7" of `"scan":7,` for the name "scan" with its quotes and colon.
std::string_view json_value(std::string_view line, std::string_view name) {
  const std::size_t at = line.find(name);
  if (at == std::string_view::npos) return {};
  line.remove_prefix(at + name.size());
  while (line.starts_with(' ')) line.remove_prefix(1);
  return line.substr(0, line.find_first_of(",} "));
}

}  // namespace

void point_lines::read_names(std::string_view line) {
  has_names_ = true;
  for_each_field(line, [this](std::size_t column, std::string_view name) {
    if (name == "scan") columns_.scan = column;
    if (name == "angle_deg") columns_.angle = column;
    if (name == "range_mm" || name == "range_m") columns_.range = column;
    if (name == "range_m") mm_ = 1000.0F;
    if (name == "time_ns") columns_.time = column;
    if (name == "intensity") columns_.intensity = column;
    if (name == "sample_flags") columns_.sample_flags = column;
  });
  has_intensity_ = columns_.intensity != no_column;
  has_sample_flags_ = columns_.sample_flags != no_column;
  is_foreign_ = columns_.angle == no_column || columns_.range == no_column;
}

point_lines::fields point_lines::csv_fields(std::string_view line) const {
  fields found;
  for_each_field(line, [&](std::size_t column, std::string_view field) {
    if (column == columns_.scan) found.scan = field;
    if (column == columns_.angle) found.angle = field;
    if (column == columns_.range) found.range = field;
    if (column == columns_.time) found.time = field;
    if (column == columns_.intensity) found.intensity = field;
    if (column == columns_.sample_flags) found.sample_flags = field;
  });
  return found;
}

point_lines::fields point_lines::json_fields(std::string_view line) {
  fields found;
  found.scan = json_value(line, "\"scan\":");
  found.angle = json_value(line, "\"angle_deg\":");
  found.range = json_value(line, "\"range_mm\":");
  found.time = json_value(line, "\"time_ns\":");
  found.intensity = json_value(line, "\"intensity\":");
  found.sample_flags = json_value(line, "\"sample_flags\":");
  has_intensity_ = has_intensity_ || !found.intensity.empty();
  has_sample_flags_ = has_sample_flags_ || !found.sample_flags.empty();
  mm_ = 1.0F;
  if (found.range.empty()) {
    found.range = json_value(line, "\"range_m\":");
    mm_ = 1000.0F;
  }
  return found;
}

std::string_view point_lines::unexpected() const noexcept {
  if (has_intensity_ && !g4lidar::has_intensity(*model_)) return "intensity";
  const bool has_flags = g4lidar::has_sample_flags(model_->samples.layout);
  return has_sample_flags_ && !has_flags ? "sample_flags" : "";
}

std::optional<point> point_lines::point_of(const fields& found) {
  point made;
  float angle_deg = 0.0F;
  float range = 0.0F;
  const bool has_angle = read_number(found.angle, angle_deg) && std::abs(angle_deg) <= 360.0F;
  const bool has_range = read_number(found.range, range) && range >= 0.0F && range * mm_ < 1e8F;
  constexpr std::uint8_t most_flags = 3;
  const auto is_bad = [this](std::string_view column, bool bad) {
    if (bad) bad_column_ = column;
    return bad;
  };
  if (is_bad("angle_deg", !has_angle) || is_bad(mm_ > 1.0F ? "range_m" : "range_mm", !has_range) ||
      is_bad("scan", !read_if_any(found.scan, made.revolution)) ||
      is_bad("time_ns", !read_if_any(found.time, made.time_ns)) ||
      is_bad("intensity", !read_if_any(found.intensity, made.intensity)) ||
      is_bad("sample_flags", !read_if_any(found.sample_flags, made.sample_flags) ||
                                 made.sample_flags > most_flags)) {
    return std::nullopt;
  }
  if (frame_ == frame::robot) angle_deg = static_cast<float>(model_->turn_deg) - angle_deg;
  if (angle_deg < 0.0F) angle_deg += 360.0F;
  made.angle_deg = angle_deg < 360.0F ? angle_deg : angle_deg - 360.0F;
  made.range_mm = range * mm_;
  if (made.range_mm == 0.0F) made.flags = point_flags::no_return;
  if (made.range_mm > 0.0F && made.range_mm < static_cast<float>(model_->range.min_mm)) {
    made.flags = point_flags::too_near;
  }
  return made;
}

std::optional<read_point> point_lines::read(std::string_view line) {
  if (form_ == text_source::csv && !has_names_) {
    read_names(line);
    return std::nullopt;
  }
  const auto made = point_of(form_ == text_source::csv ? csv_fields(line) : json_fields(line));
  if (!made) return std::nullopt;
  read_point read{*made};
  if (form_ == text_source::csv) return read;
  const std::string_view partial = json_value(line, "\"partial\":");
  if (!partial.empty()) read.partial = partial == "true";
  return read;
}

text_points::text_points(text_source form, frame in, point_writer& writer, text_sink& out,
                         const model& model)
    : lines_(form, in, model), writer_(writer), out_(out), by_scan_(writer.takes_scans()) {
  gathered_.reserve(by_scan_ ? 2 * largest_scan(model) : 512);
  is_header_due_ = form == text_source::csv;
}

void text_points::take(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) {
      is_too_long_ = is_too_long_ || rest_.size() + text.size() > longest_line;
      if (is_too_long_) rest_.clear();
      if (!is_too_long_) rest_ += text;
      return;
    }
    if (is_too_long_) {
      ++lines_read_;
      count_bad_line({});
    } else if (rest_.empty()) {
      take_line(text.substr(0, end));
    } else {
      rest_ += text.substr(0, end);
      take_line(rest_);
    }
    is_too_long_ = false;
    rest_.clear();
    text.remove_prefix(end + 1);
  }
}

void text_points::take_line(std::string_view line) {
  ++lines_read_;
  if (line.ends_with('\r')) line.remove_suffix(1);
  if (line.empty() || lines_.is_foreign() || !unexpected().empty()) return;
  const auto found = lines_.read(line);
  if (!unexpected().empty()) return;
  if (found) return take_point(*found);
  if (!is_header_due_) count_bad_line(lines_.bad_column());
  is_header_due_ = false;
}

void text_points::count_bad_line(std::string_view column) noexcept {
  if (bad_lines_++ == 0) first_bad_ = {lines_read_, column};
}

void text_points::take_point(const read_point& read) {
  if (!begun_) writer_.begin(out_);
  begun_ = true;
  ++points_;
  point next = read.point;
  const bool is_next_scan = !gathered_.empty() && gathered_.back().revolution != next.revolution;
  if (by_scan_ && is_next_scan) hand_over(false);
  if (gathered_.size() == gathered_.capacity()) hand_over(true);
  if (points_ > 1 && next.revolution != revolution_) {
    next.flags = next.flags | point_flags::revolution_start;
  }
  revolution_ = next.revolution;
  if (read.partial) partial_ = partial_.value_or(false) || *read.partial;
  gathered_.push_back(next);
}

void text_points::hand_over(bool cut) {
  if (gathered_.empty()) return;
  if (!by_scan_) {
    writer_.write_points(gathered_, out_);
    return gathered_.clear();
  }
  using enum scan_flags;
  scan_record shown;
  shown.scan.points = gathered_;
  shown.scan.model = &lines_.model();
  shown.scan.revolution = gathered_.front().revolution;
  // If the lines do not contain it, it is not known whether the first and the last one are
  // complete.
  if (!partial_ && (is_first_scan_ || was_cut_)) shown.scan.flags = start_missing;
  if (!partial_ && cut) shown.scan.flags = shown.scan.flags | end_missing;
  if (partial_.value_or(false)) shown.scan.flags = data_lost;
  shown.time_ns = gathered_.front().time_ns;
  writer_.write_scan(shown, out_);
  is_first_scan_ = false;
  partial_.reset();
  was_cut_ = cut;
  gathered_.clear();
}

void text_points::finish() {
  if (is_too_long_) {
    ++lines_read_;
    count_bad_line({});
  }
  if (!rest_.empty()) take_line(std::exchange(rest_, {}));
  hand_over(true);
}

}  // namespace g4_tool
