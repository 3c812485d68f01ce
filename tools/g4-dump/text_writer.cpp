// SPDX-License-Identifier: MIT
// Columns for people. What a program reads is csv or jsonl: this may change.
#include <fmt/format.h>

#include <array>
#include <string_view>

#include "digits.hpp"
#include "point_writer.hpp"
#include "scan_summary.hpp"

namespace g4_dump {
namespace {

/// A number in the making.
struct cell {
  std::array<char, 32 + slack> text;

  [[nodiscard]] std::string_view until(const char* end) const {
    return {text.data(), static_cast<std::size_t>(end - text.data())};
  }
};

/// A line for each point.
class text_points : public point_writer {
 public:
  explicit text_points(const point_style& style) : style_(style) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return false; }

  void begin(output& out) override {
    out.write(fmt::format("  scan  angle_deg  {:>9}  {:>{}}\n",
                          fmt::format("range_{}", style_.unit_name()), "time_s",
                          style_.time_width + 7));
  }

  void write_points(std::span<const g4lidar::point> points, output& out) override {
    for (const g4lidar::point& p : points) {
      if (style_.leaves_out(p)) continue;
      char* const at = out.room(max_line);
      out.wrote(put_line(at, p));
    }
  }

 private:
  static constexpr std::size_t max_line = 256;

  char* put_line(char* at, const g4lidar::point& p) const {
    cell angle;
    cell range;
    cell time;
    const auto degrees = angle.until(put_direction(angle.text.data(), p));
    const auto length =
        p.is_no_return() ? std::string_view("-") : range.until(put_range(range.text.data(), p));
    const auto seconds = time.until(put_seconds(time.text.data(), p.time_ns));
    return fmt::format_to(at, "{:6}  {:>9}  {:>9}  {:>{}}{}\n", p.revolution, degrees, length,
                          seconds, style_.time_width + 7, p.is_too_near() ? "  too near" : "");
  }

  char* put_direction(char* at, const g4lidar::point& p) const noexcept {
    const auto degrees = static_cast<double>(p.angle_deg);
    return style_.frame == g4lidar::frame::robot ? put_signed_angle<2>(at, degrees)
                                                 : put_angle<2>(at, degrees);
  }
  char* put_range(char* at, const g4lidar::point& p) const noexcept {
    const auto range_mm = static_cast<double>(p.range_mm);
    return style_.unit == length_unit::metres ? put_scaled<5>(at, nearest(range_mm * 100.0))
                                              : put_fixed<2>(at, range_mm);
  }
  /// With six decimals, cut off and not rounded.
  static char* put_seconds(char* at, std::int64_t time_ns) noexcept {
    const bool is_negative = time_ns < 0;
    const auto number = static_cast<std::uint64_t>(time_ns);
    const std::uint64_t magnitude = is_negative ? std::uint64_t{0} - number : number;
    if (is_negative) *at++ = '-';
    at = put_number(at, magnitude / 1'000'000'000U);
    *at++ = '.';
    const auto decimals = static_cast<std::uint32_t>(magnitude % 1'000'000'000U / 1'000U);
    put_word(at, eight_digits(decimals) >> 16U);
    return at + 6;
  }

  point_style style_;
};

/// A line for each revolution.
class text_scans : public point_writer {
 public:
  explicit text_scans(const point_style& style) : style_(style) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return true; }

  void begin(output& out) override {
    out.write("  scan  points  returns  turned_deg  reported_hz  measured_hz  partial\n");
  }

  void write_scan(const shown_scan& shown, output& out) override {
    const g4lidar::scan& scan = shown.scan;
    const scan_summary summary = summary_of(shown, style_);
    const std::string why =
        scan.is_partial() ? "partial: " + names_of(scan.marks, "", ", ", "") : "whole";
    out.write(fmt::format("{:6}  {:6}  {:7}  {:10.2f}  {:>11}  {:>11}  {}\n", scan.revolution,
                          summary.points, summary.returns, scan.turned_deg,
                          known(summary.reported_hz, 1), known(shown.measured_hz, 2), why));
  }

 private:
  static std::string known(double hz, int decimals) {
    return hz > 0.0 ? fmt::format("{:.{}f}", hz, decimals) : std::string("-");
  }

  point_style style_;
};

}  // namespace

std::unique_ptr<point_writer> make_text_writer(const point_style& style) {
  if (style.scans) return std::make_unique<text_scans>(style);
  return std::make_unique<text_points>(style);
}

}  // namespace g4_dump
