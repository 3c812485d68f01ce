// SPDX-License-Identifier: MIT
// Prints errors, points and scans to a std::ostream. An optional header.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <string_view>
#include <system_error>
#include <utility>

#include "g4lidar/error.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"

namespace g4lidar {

namespace detail {

/// A text in its own memory; longer text is cut off. *Never allocates.*
class short_text {
 public:
  short_text& add(std::string_view more) noexcept {
    const std::size_t count = std::min(more.size(), text_.size() - size_);
    std::copy_n(more.begin(), count, text_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += count;
    return *this;
  }
  short_text& add(float value, int digits) noexcept {
    return written(std::to_chars(free(), end(), value, std::chars_format::fixed, digits));
  }
  short_text& add(std::uint64_t value) noexcept {
    return written(std::to_chars(free(), end(), value));
  }
  /// Valid as long as this.
  [[nodiscard]] std::string_view view() const& noexcept { return {text_.data(), size_}; }
  std::string_view view() const&& = delete;

 private:
  char* free() noexcept { return text_.data() + size_; }
  char* end() noexcept { return text_.data() + text_.size(); }
  short_text& written(std::to_chars_result to) noexcept {
    if (to.ec == std::errc()) size_ = static_cast<std::size_t>(to.ptr - text_.data());
    return *this;
  }

  std::array<char, 128> text_{};
  std::size_t size_ = 0;
};

/// A flag that makes a point doubtful, and its name for people.
struct doubt {
  point_flags flag;
  std::string_view words;
};
inline constexpr std::array<doubt, 6> doubts{{
    {point_flags::too_near, "too near"},
    {point_flags::not_deskewed, "not deskewed"},
    {point_flags::unlikely, "unlikely"},
    {point_flags::isolated, "isolated"},
    {point_flags::veiling, "veiling"},
    {point_flags::may_be_too_near, "may be too near"},
}};

/// "12.345 deg, 1234.5 mm"; "12.345 deg, no return"; "12.345 deg, 60.0 mm, too near, unlikely".
[[nodiscard]] inline short_text text_of(const point& p) noexcept {
  short_text text;
  text.add(p.angle_deg, 3).add(" deg, ");
  if (p.is_no_return()) {
    text.add("no return");
  } else {
    text.add(p.range_mm, 1).add(" mm");
  }
  for (const doubt& each : doubts) {
    if ((p.flags & each.flag) != point_flags::none) text.add(", ").add(each.words);
  }
  return text;
}

/// "scan 12: 1286 points"; "scan 12: 640 points, end_missing data_lost".
[[nodiscard]] inline short_text text_of(const scan& s) noexcept {
  short_text text;
  text.add("scan ").add(s.revolution).add(": ").add(s.points.size()).add(" points");
  std::string_view before = ", ";
  const auto flag = [&](scan_flags flags, std::string_view name) {
    if (s.has(flags)) text.add(std::exchange(before, " ")).add(name);
  };
  flag(scan_flags::start_missing, "start_missing");
  flag(scan_flags::end_missing, "end_missing");
  flag(scan_flags::data_lost, "data_lost");
  flag(scan_flags::turn_short, "turn_short");
  flag(scan_flags::start_by_angle, "start_by_angle");
  flag(scan_flags::end_by_angle, "end_by_angle");
  flag(scan_flags::crc_mismatch, "crc_mismatch");
  return text;
}

}  // namespace detail

/// The name, such as "permission".
inline std::ostream& operator<<(std::ostream& out, problem code) { return out << name_of(code); }
/// The name, such as "opening".
inline std::ostream& operator<<(std::ostream& out, task doing) { return out << name_of(doing); }
/// The message.
inline std::ostream& operator<<(std::ostream& out, const error& why) {
  return out << why.message();
}
/// "12.345 deg, 1234.5 mm", or "no return" in place of the range.
inline std::ostream& operator<<(std::ostream& out, const point& p) {
  const auto text = detail::text_of(p);
  return out << text.view();
}
/// "scan 12: 1286 points", and its flags.
inline std::ostream& operator<<(std::ostream& out, const scan& s) {
  const auto text = detail::text_of(s);
  return out << text.view();
}

}  // namespace g4lidar
