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
class csv_points : public point_writer {
 public:
  explicit csv_points(const point_style& style) : style_(style) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return false; }

  void begin(output& out) override { out.write("scan,angle_deg,range_mm,time_ns\n"); }

  void write_points(std::span<const g4lidar::point> points, output& out) override {
    char* at = out.room(points.size() * max_row + slack);
    for (const g4lidar::point& p : points) {
      if (style_.leaves_out(p)) continue;
      at = put_row(at, p);
    }
    out.wrote(at);
  }

 private:
  // 10 digits of the scan, 10 characters of the angle, 11 of the range, 19 of the time, and marks.
  static constexpr std::size_t max_row = 64;

  char* put_row(char* at, const g4lidar::point& p) noexcept {
    if (p.revolution != scan_) keep_scan(p.revolution);
    std::memcpy(at, scan_text_.data(), 16);
    at = put_angle<6>(at + scan_length_, static_cast<double>(p.angle_deg));
    *at++ = ',';
    at = put_fixed<2>(at, static_cast<double>(p.range_mm));
    *at++ = ',';
    at = time_.put(at, static_cast<std::uint64_t>(p.time_ns));
    *at++ = '\n';
    return at;
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

/// A row for each revolution.
class csv_scans : public point_writer {
 public:
  explicit csv_scans(const point_style& style) : style_(style) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return true; }

  void begin(output& out) override {
    out.write("scan,time_ns,points,returns,partial,why,turned_deg,reported_hz,measured_hz\n");
  }

  void write_scan(const g4lidar::scan& scan, output& out) override {
    const scan_summary summary = summary_of(scan, style_);
    out.write(fmt::format("{},{},{},{},{},{},{:.2f},{},{}\n", scan.revolution, summary.time_ns,
                          summary.points, summary.returns, scan.is_partial(),
                          names_of(scan.marks, "", "+", ""), scan.turned_deg,
                          known(summary.reported_hz, 1), known(summary.measured_hz, 3)));
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
  return std::make_unique<csv_points>(style);
}

}  // namespace g4_dump
