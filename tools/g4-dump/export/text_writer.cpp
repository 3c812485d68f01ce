// SPDX-License-Identifier: MIT
// Columns for people; they may change. For programs there are csv and jsonl.
#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "value_text.hpp"

namespace g4_tool {
namespace {

/// A line per point.
class point_columns final : public point_writer {
 public:
  explicit point_columns(const text_style& style) : style_(style) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return false; }

  void begin(text_sink& out) override {
    const std::string range = std::string("range_") + name_of(style_.unit);
    out.write("  scan  angle_deg  " + in_column(9, range) + "  " +
              in_column(time_width(), "time_s") + "\n");
  }

  void write_points(std::span<const point> points, text_sink& out) override {
    for (const point& p : points) {
      char* const at = out.room(2 * max_line);
      out.wrote(put_line(at, p));
    }
  }

 private:
  static constexpr std::size_t max_line = 256;

  [[nodiscard]] unsigned time_width() const noexcept {
    return std::min<unsigned>(style_.time_width, max_line / 2) + 7;
  }

  char* put_line(char* out, const point& p) const noexcept {
    const auto right = [&out](unsigned width, auto put) {
      std::array<char, 48> text;
      const auto size = static_cast<std::size_t>(put(text.data()) - text.data());
      for (std::size_t i = size; i < width; ++i) *out++ = ' ';
      out = digits::put_text(out, {text.data(), size});
    };
    right(6, [&](char* to) { return digits::put_number(to, p.revolution); });
    right(2, [](char* to) { return to; });
    right(9, [&](char* to) { return put_angle_column<2>(to, p, style_.to, style_.turn_deg); });
    right(2, [](char* to) { return to; });
    right(9, [&](char* to) {
      return p.is_no_return() ? digits::put_text(to, "-") : put_range_column(to, p, style_.unit);
    });
    right(2, [](char* to) { return to; });
    right(time_width(), [&](char* to) { return put_seconds(to, p.time_ns); });
    std::string_view before = "  ";
    for (const doubt_name& each : doubts) {
      if ((p.flags & each.flag) == point_flags::none) continue;
      char* const words = digits::put_text(out, std::exchange(before, ", "));
      out = digits::put_text(words, each.name);
      std::replace(words, out, '_', ' ');
    }
    return digits::put_text(out, "\n");
  }

  text_style style_;
};

/// A line per revolution.
class scan_columns final : public point_writer {
 public:
  [[nodiscard]] bool takes_scans() const noexcept override { return true; }

  void begin(text_sink& out) override {
    out.write("  scan  points  returns  turned_deg  reported_hz  measured_hz  state\n");
  }

  void write_scan(const scan_record& record, text_sink& out) override {
    const scan& scan = record.scan;
    out.write(in_column(6, std::to_string(scan.revolution)) + "  " +
              in_column(6, std::to_string(scan.points.size())) + "  " +
              in_column(7, std::to_string(returns_in(scan.points))) + "  " +
              in_column(10, with_decimals(static_cast<double>(scan.turned_deg), 2)) + "  " +
              in_column(11, if_known(reported_hz(scan), 1, "-")) + "  " +
              in_column(11, if_known(record.measured_hz, 2, "-")) + "  ");
    out.write(scan.is_partial() ? "partial: " + names_of(scan.flags, "", ", ", "") : "whole");
    out.write("\n");
  }
};

}  // namespace

std::unique_ptr<point_writer> make_text_writer(const text_style& style) {
  if (style.scans) return std::make_unique<scan_columns>();
  return std::make_unique<point_columns>(style);
}

}  // namespace g4_tool
