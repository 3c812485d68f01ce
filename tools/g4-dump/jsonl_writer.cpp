// SPDX-License-Identifier: MIT
// JSON, one object a line. A point says whether its revolution was seen whole, so a revolution is
// written when it is over.
#include <fmt/format.h>

#include "digits.hpp"
#include "point_writer.hpp"
#include "scan_summary.hpp"

namespace g4_dump {
namespace {

char* put_bool(char* at, bool yes) noexcept { return put_text(at, yes ? "true" : "false"); }

/// An object for each point.
class jsonl_points : public point_writer {
 public:
  explicit jsonl_points(const point_style& style) : style_(style) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return true; }

  void write_scan(const g4lidar::scan& scan, output& out) override {
    for (const g4lidar::point& p : scan.points) {
      if (style_.leaves_out(p)) continue;
      out.wrote(put_object(out.room(max_object), p, scan.is_partial()));
    }
  }

 private:
  static constexpr std::size_t max_object = 256;

  static char* put_object(char* at, const g4lidar::point& p, bool partial) noexcept {
    at = put_number(put_text(at, "{\"scan\":"), p.revolution);
    at = put_angle<6>(put_text(at, ",\"angle_deg\":"), static_cast<double>(p.angle_deg));
    at = put_fixed<2>(put_text(at, ",\"range_mm\":"), static_cast<double>(p.range_mm));
    at = put_number(put_text(at, ",\"time_ns\":"), static_cast<std::uint64_t>(p.time_ns));
    at = put_bool(put_text(at, ",\"no_return\":"), p.is_no_return());
    at = put_bool(put_text(at, ",\"too_near\":"), p.is_too_near());
    at = put_bool(put_text(at, ",\"partial\":"), partial);
    return put_text(at, "}\n");
  }

  point_style style_;
};

/// An object for each revolution, its points in columns.
class jsonl_scans : public point_writer {
 public:
  explicit jsonl_scans(const point_style& style) : style_(style) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return true; }

  void write_scan(const g4lidar::scan& scan, output& out) override {
    const scan_summary summary = summary_of(scan, style_);
    out.write(fmt::format(
        R"({{"scan":{},"partial":{},"why":[{}],"points":{},"returns":{},"suspect_samples":{},)"
        R"("turned_deg":{:.2f},"reported_hz":{},"measured_hz":{})",
        scan.revolution, scan.is_partial(), names_of(scan.marks, "\"", ",", "\""), summary.points,
        summary.returns, scan.suspect_samples, scan.turned_deg, known(summary.reported_hz, 1),
        known(summary.measured_hz, 3)));
    write_column(scan, "angle_deg", out, [](char* at, const g4lidar::point& p) {
      return put_angle<6>(at, static_cast<double>(p.angle_deg));
    });
    write_column(scan, "range_mm", out, [](char* at, const g4lidar::point& p) {
      return put_fixed<2>(at, static_cast<double>(p.range_mm));
    });
    write_column(scan, "time_ns", out, [](char* at, const g4lidar::point& p) {
      return put_number(at, static_cast<std::uint64_t>(p.time_ns));
    });
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
