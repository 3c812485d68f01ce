// SPDX-License-Identifier: MIT
// Comma-separated values. The columns here are stable: more may follow, none changes its place.
#include <fmt/format.h>

#include <array>
#include <cstring>
#include <limits>

#include "digits.hpp"
#include "point_writer.hpp"
#include "scan_summary.hpp"

namespace g4_dump {
namespace {

/// A row for each point.
template <g4lidar::frame Frame, length_unit Unit>
class csv_points : public point_writer {
 public:
  explicit csv_points(const point_style& style) : style_(style) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return false; }

  void begin(output& out) override {
    out.write(fmt::format("scan,angle_deg,range_{},time_ns\n", style_.unit_name()));
  }

  void write_points(std::span<const g4lidar::point> points, output& out) override {
    char* at = out.room(points.size() * max_row + slack);
    for (const g4lidar::point& p : points) {
      if (style_.leaves_out(p)) continue;
      at = put_row(at, p);
    }
    out.wrote(at);
  }

 private:
  // 10 digits of the scan, 11 characters of the angle, 11 of the range, 20 of the time, and marks.
  static constexpr std::size_t max_row = 64;

  char* put_row(char* at, const g4lidar::point& p) noexcept {
    if (p.revolution != scan_) keep_scan(p.revolution);
    std::memcpy(at, scan_text_.data(), 16);
    at = put_direction(at + scan_length_, static_cast<double>(p.angle_deg));
    *at++ = ',';
    at = put_range(at, static_cast<double>(p.range_mm));
    *at++ = ',';
    const bool is_negative = p.time_ns < 0;
    *at = '-';
    at += is_negative ? 1 : 0;
    const auto number = static_cast<std::uint64_t>(p.time_ns);
    at = time_.put(at, is_negative ? std::uint64_t{0} - number : number);
    *at++ = '\n';
    return at;
  }

  static char* put_direction(char* at, double angle_deg) noexcept {
    if constexpr (Frame == g4lidar::frame::robot) return put_signed_angle<6>(at, angle_deg);
    return put_angle<6>(at, angle_deg);
  }

  static char* put_range(char* at, double range_mm) noexcept {
    if constexpr (Unit == length_unit::metres) return put_scaled<5>(at, nearest(range_mm * 100.0));
    return put_fixed<2>(at, range_mm);
  }

  void keep_scan(std::uint32_t scan) noexcept {
    scan_ = scan;
    char* const end = put_number(scan_text_.data(), scan);
    *end = ',';
    scan_length_ = end + 1 - scan_text_.data();
  }

  point_style style_;
  std::uint32_t scan_ = 0;
  std::ptrdiff_t scan_length_ = 2;
  std::array<char, 32> scan_text_{'0', ','};
  growing_number time_;
};

template <g4lidar::frame Frame>
std::unique_ptr<point_writer> make_csv_points(const point_style& style) {
  if (style.unit == length_unit::millimetres) {
    return std::make_unique<csv_points<Frame, length_unit::millimetres>>(style);
  }
  return std::make_unique<csv_points<Frame, length_unit::metres>>(style);
}

/// A row for each revolution.
class csv_scans : public point_writer {
 public:
  explicit csv_scans(const point_style& style) : style_(style) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return true; }

  void begin(output& out) override {
    out.write("scan,time_ns,points,returns,partial,why,turned_deg,reported_hz,measured_hz\n");
  }

  void write_scan(const shown_scan& shown, output& out) override {
    const g4lidar::scan& scan = shown.scan;
    const scan_summary summary = summary_of(shown, style_);
    out.write(fmt::format("{},{},{},{},{},{},{:.2f},{},{}\n", scan.revolution, shown.time_ns,
                          summary.points, summary.returns, scan.is_partial(),
                          names_of(scan.marks, "", "+", ""), scan.turned_deg,
                          known(summary.reported_hz, 1), known(shown.measured_hz, 3)));
  }

 private:
  static std::string known(double hz, int decimals) {
    return hz > 0.0 ? fmt::format("{:.{}f}", hz, decimals) : std::string();
  }

  point_style style_;
};

}  // namespace

std::unique_ptr<point_writer> make_csv_writer(const point_style& style) {
  if (style.scans) return std::make_unique<csv_scans>(style);
  if (style.frame == g4lidar::frame::vendor) return make_csv_points<g4lidar::frame::vendor>(style);
  return make_csv_points<g4lidar::frame::robot>(style);
}

}  // namespace g4_dump
