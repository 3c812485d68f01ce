// SPDX-License-Identifier: MIT
// JSON, one object a line. A point says whether its revolution was seen whole, so a revolution is
// written when it is over.
#include <fmt/format.h>

#include <string>

#include "digits.hpp"
#include "point_writer.hpp"
#include "scan_summary.hpp"

namespace g4_dump {
namespace {

char* put_bool(char* at, bool yes) noexcept { return put_text(at, yes ? "true" : "false"); }

char* put_direction(char* at, const g4lidar::point& p, const point_style& style) noexcept {
  const auto degrees = static_cast<double>(p.angle_deg);
  return style.frame == g4lidar::frame::robot ? put_signed_angle<6>(at, degrees)
                                              : put_angle<6>(at, degrees);
}

char* put_range(char* at, const g4lidar::point& p, const point_style& style) noexcept {
  const auto range_mm = static_cast<double>(p.range_mm);
  return style.unit == length_unit::metres ? put_scaled<5>(at, nearest(range_mm * 100.0))
                                           : put_fixed<2>(at, range_mm);
}

/// An object for each point.
class jsonl_points : public point_writer {
 public:
  explicit jsonl_points(const point_style& style)
      : style_(style), range_name_(fmt::format(",\"range_{}\":", style.unit_name())) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return !style_.as_they_come; }

  void write_points(std::span<const g4lidar::point> points, output& out) override {
    for (const g4lidar::point& p : points) {
      if (style_.leaves_out(p)) continue;
      out.wrote(put_text(put_point(out.room(max_object), p), "}\n"));
    }
  }

  void write_scan(const shown_scan& shown, output& out) override {
    for (const g4lidar::point& p : shown.scan.points) {
      if (style_.leaves_out(p)) continue;
      char* at = put_text(put_point(out.room(max_object), p), ",\"partial\":");
      at = put_bool(at, shown.scan.is_partial());
      out.wrote(put_text(at, "}\n"));
    }
  }

 private:
  static constexpr std::size_t max_object = 256;

  char* put_point(char* at, const g4lidar::point& p) const noexcept {
    at = put_number(put_text(at, "{\"scan\":"), p.revolution);
    at = put_direction(put_text(at, ",\"angle_deg\":"), p, style_);
    at = put_range(put_text(at, range_name_), p, style_);
    at = put_signed(put_text(at, ",\"time_ns\":"), p.time_ns);
    at = put_bool(put_text(at, ",\"no_return\":"), p.is_no_return());
    return put_bool(put_text(at, ",\"too_near\":"), p.is_too_near());
  }

  point_style style_;
  std::string range_name_;
};

/// An object for each revolution, its points in columns.
class jsonl_scans : public point_writer {
 public:
  explicit jsonl_scans(const point_style& style) : style_(style) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return true; }

  void write_scan(const shown_scan& shown, output& out) override {
    const g4lidar::scan& scan = shown.scan;
    const scan_summary summary = summary_of(shown, style_);
    out.write(fmt::format(
        R"({{"scan":{},"partial":{},"why":[{}],"points":{},"returns":{},"suspect_samples":{},)"
        R"("turned_deg":{:.2f},"reported_hz":{},"measured_hz":{})",
        scan.revolution, scan.is_partial(), names_of(scan.marks, "\"", ",", "\""), summary.points,
        summary.returns, scan.suspect_samples, scan.turned_deg, known(summary.reported_hz, 1),
        known(shown.measured_hz, 3)));
    write_column(scan, "angle_deg", out, [this](char* at, const g4lidar::point& p) {
      return put_direction(at, p, style_);
    });
    write_column(scan, fmt::format("range_{}", style_.unit_name()), out,
                 [this](char* at, const g4lidar::point& p) { return put_range(at, p, style_); });
    write_column(scan, "time_ns", out,
                 [](char* at, const g4lidar::point& p) { return put_signed(at, p.time_ns); });
    out.write("}\n");
  }

 private:
  static constexpr std::size_t max_number = 48;

  static std::string known(double hz, int decimals) {
    return hz > 0.0 ? fmt::format("{:.{}f}", hz, decimals) : std::string("null");
  }

  template <class Put>
  void write_column(const g4lidar::scan& scan, std::string_view name, output& out,
                    const Put& put) const {
    out.write(fmt::format(",\"{}\":[", name));
    bool first = true;
    for (const g4lidar::point& p : scan.points) {
      if (style_.leaves_out(p)) continue;
      char* at = out.room(max_number);
      if (!first) *at++ = ',';
      first = false;
      out.wrote(put(at, p));
    }
    out.write("]");
  }

  point_style style_;
};

}  // namespace

std::unique_ptr<point_writer> make_jsonl_writer(const point_style& style) {
  if (style.scans) return std::make_unique<jsonl_scans>(style);
  return std::make_unique<jsonl_points>(style);
}

}  // namespace g4_dump
