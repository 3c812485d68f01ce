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

  void begin(output& out) override { out.write("  scan  angle_deg   range_mm        time_s\n"); }

  void write_points(std::span<const g4lidar::point> points, output& out) override {
    for (const g4lidar::point& p : points) {
      if (style_.leaves_out(p)) continue;
      char* const at = out.room(max_line);
      out.wrote(put_line(at, p));
    }
  }

 private:
  static constexpr std::size_t max_line = 256;

  static char* put_line(char* at, const g4lidar::point& p) {
    cell angle;
    cell range;
    const auto degrees =
        angle.until(put_angle<2>(angle.text.data(), static_cast<double>(p.angle_deg)));
    const auto millimetres =
        p.is_no_return()
            ? std::string_view("-")
            : range.until(put_fixed<2>(range.text.data(), static_cast<double>(p.range_mm)));
    return fmt::format_to(at, "{:6}  {:>9}  {:>9}  {:5}.{:06}{}\n", p.revolution, degrees,
                          millimetres, p.time_ns / 1'000'000'000, p.time_ns % 1'000'000'000 / 1'000,
                          p.is_too_near() ? "  too near" : "");
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

  void write_scan(const g4lidar::scan& scan, output& out) override {
    const scan_summary summary = summary_of(scan, style_);
    const std::string why =
        scan.is_partial() ? "partial: " + names_of(scan.marks, "", ", ", "") : "whole";
    out.write(fmt::format("{:6}  {:6}  {:7}  {:10.2f}  {:>11}  {:>11}  {}\n", scan.revolution,
                          summary.points, summary.returns, scan.turned_deg,
                          known(summary.reported_hz, 1), known(summary.measured_hz, 2), why));
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
