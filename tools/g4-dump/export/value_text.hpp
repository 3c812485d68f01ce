// SPDX-License-Identifier: MIT
// The values of points and scans as text, for all formats. The columns of csv are in csv_writer.cpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "digits.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"
#include "point_writer.hpp"

namespace g4_tool {

/// The angle in `Frame` with this number of decimals, at most 11 characters.
template <frame Frame, unsigned Decimals = 6>
char* put_angle_column(char* out, const point& p, std::uint16_t turn_deg) noexcept {
  if constexpr (Frame == frame::robot) {
    const float degrees = bearing_deg(p.angle_deg, Frame, turn_deg);
    return digits::put_signed_angle<Decimals>(out, static_cast<double>(degrees));
  }
  return digits::put_angle<Decimals>(out, static_cast<double>(p.angle_deg));
}
template <unsigned Decimals = 6>
char* put_angle_column(char* out, const point& p, frame to, std::uint16_t turn_deg) noexcept {
  return to == frame::robot ? put_angle_column<frame::robot, Decimals>(out, p, turn_deg)
                            : put_angle_column<frame::vendor, Decimals>(out, p, turn_deg);
}

/// The range: millimetres with two decimals, metres with five, so that no digit is lost.
template <length_unit Unit>
char* put_range_column(char* out, const point& p) noexcept {
  const auto range_mm = static_cast<double>(p.range_mm);
  if constexpr (Unit == length_unit::millimetres) return digits::put_fixed<2>(out, range_mm);
  return digits::put_scaled<5>(out, digits::nearest(range_mm * 100.0));
}
inline char* put_range_column(char* out, const point& p, length_unit unit) noexcept {
  return unit == length_unit::metres ? put_range_column<length_unit::metres>(out, p)
                                     : put_range_column<length_unit::millimetres>(out, p);
}

[[nodiscard]] inline const char* name_of(length_unit unit) noexcept {
  return unit == length_unit::metres ? "m" : "mm";
}

/// Seconds with six decimals, truncated; at most 20 characters.
char* put_seconds(char* out, std::int64_t time_ns) noexcept;

/// Any finite number, rounded as printf does.
[[nodiscard]] std::string with_decimals(double number, int decimals);
/// With the least number of digits that distinguishes the number from all others of its type.
[[nodiscard]] std::string shortest(double number);
[[nodiscard]] std::string shortest(float number);
/// A number above 0, or else `unknown`.
[[nodiscard]] std::string if_known(double number, int decimals, const char* unknown);
/// `text`, right-aligned.
[[nodiscard]] std::string in_column(std::size_t width, const std::string& text);

[[nodiscard]] std::size_t returns_in(std::span<const point> points) noexcept;
/// 0 if the device did not report it.
[[nodiscard]] inline double reported_hz(const scan& scan) noexcept {
  return scan.reported_frequency_chz / 100.0;
}
/// A flag that makes a point doubtful, and its name in jsonl.
struct doubt_name {
  point_flags flag;
  std::string_view name;
};
inline constexpr std::array<doubt_name, 6> doubts{{
    {point_flags::too_near, "too_near"},
    {point_flags::not_deskewed, "not_deskewed"},
    {point_flags::unlikely, "unlikely"},
    {point_flags::isolated, "isolated"},
    {point_flags::veiling, "veiling"},
    {point_flags::may_be_too_near, "may_be_too_near"},
}};

/// The names of the set flags, with `before` and `after` each and `between` them.
[[nodiscard]] std::string names_of(scan_flags flags, std::string_view before,
                                   std::string_view between, std::string_view after);

// The writers that make_point_writer() creates.
[[nodiscard]] std::unique_ptr<point_writer> make_csv_writer(const text_style& style);
[[nodiscard]] std::unique_ptr<point_writer> make_jsonl_writer(const text_style& style);
[[nodiscard]] std::unique_ptr<point_writer> make_text_writer(const text_style& style);

}  // namespace g4_tool
