// SPDX-License-Identifier: MIT
// Comma-separated values. The columns are stable: more may follow, and none changes its position.
#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <string>

#include "value_text.hpp"

namespace g4_tool {
namespace {

/// A row per point.
template <frame Frame, length_unit Unit>
class csv_points final : public point_writer {
 public:
  explicit csv_points(const text_style& style)
      : has_intensity_(style.intensity),
        has_sample_flags_(style.sample_flags),
        turn_deg_(style.turn_deg) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return false; }

  void begin(text_sink& out) override {
    out.write(Unit == length_unit::metres ? "scan,angle_deg,range_m,time_ns"
                                          : "scan,angle_deg,range_mm,time_ns");
    if (has_intensity_) out.write(",intensity");
    if (has_sample_flags_) out.write(",sample_flags");
    out.write("\n");
  }

  void write_points(std::span<const point> points, text_sink& out) override {
    while (!points.empty()) {
      const auto piece = points.first(std::min(points.size(), most_rows));
      points = points.subspan(piece.size());
      char* at = out.room(piece.size() * max_row);
      for (const point& p : piece) at = put_row(at, p);
      out.wrote(at);
    }
  }

 private:
  // 10 digits of the scan, 11 characters of the angle, 21 of the range, 20 of the time, 5 of the
  // intensity, 3 of the flags, and 6 between and behind them.
  static constexpr std::size_t max_row = 76;
  static constexpr std::size_t most_rows = 512;

  char* put_row(char* out, const point& p) noexcept {
    if (p.revolution != scan_) keep_scan(p.revolution);
    std::memcpy(out, scan_text_.data(), scan_text_.size());
    out = put_angle_column<Frame>(out + scan_length_, p, turn_deg_);
    *out++ = ',';
    out = put_range_column<Unit>(out, p);
    *out++ = ',';
    out = digits::put_number(out, p.time_ns);
    if (has_intensity_) {
      *out++ = ',';
      out = digits::put_number(out, p.intensity);
    }
    if (has_sample_flags_) {
      *out++ = ',';
      out = digits::put_number(out, p.sample_flags);
    }
    *out++ = '\n';
    return out;
  }

  void keep_scan(std::uint32_t scan) noexcept {
    scan_ = scan;
    char* const end = digits::put_number(scan_text_.data(), scan);
    *end = ',';
    scan_length_ = end + 1 - scan_text_.data();
  }

  bool has_intensity_;
  bool has_sample_flags_;
  std::uint16_t turn_deg_;
  std::uint32_t scan_ = 0;
  std::ptrdiff_t scan_length_ = 2;
  std::array<char, 16> scan_text_{'0', ','};  // most points have the scan of those before
};

template <frame Frame>
std::unique_ptr<point_writer> make_csv_points(const text_style& style) {
  using enum length_unit;
  if (style.unit == millimetres) return std::make_unique<csv_points<Frame, millimetres>>(style);
  return std::make_unique<csv_points<Frame, metres>>(style);
}

/// A row per revolution.
class csv_scans final : public point_writer {
 public:
  [[nodiscard]] bool takes_scans() const noexcept override { return true; }

  void begin(text_sink& out) override {
    out.write("scan,time_ns,points,returns,partial,why,turned_deg,reported_hz,measured_hz\n");
  }

  void write_scan(const scan_record& record, text_sink& out) override {
    const scan& scan = record.scan;
    for (const std::string& cell :
         {std::to_string(scan.revolution), std::to_string(record.time_ns),
          std::to_string(scan.points.size()), std::to_string(returns_in(scan.points)),
          std::string(scan.is_partial() ? "true" : "false"), names_of(scan.flags, "", "+", ""),
          with_decimals(static_cast<double>(scan.turned_deg), 2),
          if_known(reported_hz(scan), 1, "")}) {
      out.write(cell + ",");
    }
    out.write(if_known(record.measured_hz, 3, "") + "\n");
  }
};

}  // namespace

std::unique_ptr<point_writer> make_csv_writer(const text_style& style) {
  if (style.scans) return std::make_unique<csv_scans>();
  if (style.to == frame::vendor) return make_csv_points<frame::vendor>(style);
  return make_csv_points<frame::robot>(style);
}

}  // namespace g4_tool
