// SPDX-License-Identifier: MIT
// JSON, one object per line. A point contains whether its revolution is complete, so a revolution
// is written when it has ended.
#include <string>

#include "value_text.hpp"

namespace g4_tool {
namespace {

using digits::put_text;

char* put_bool(char* position, bool yes) noexcept {
  return put_text(position, yes ? "true" : "false");
}

/// An object per point.
class jsonl_points final : public point_writer {
 public:
  explicit jsonl_points(const text_style& style)
      : style_(style), range_name_(std::string(",\"range_") + name_of(style.unit) + "\":") {}

  [[nodiscard]] bool takes_scans() const noexcept override { return !style_.as_they_come; }

  void write_points(std::span<const point> points, text_sink& out) override {
    for (const point& p : points) {
      out.wrote(put_text(put_point(out.room(max_object), p, style_.turn_deg), "}\n"));
    }
  }

  void write_scan(const scan_record& record, text_sink& out) override {
    for (const point& p : record.scan.points) {
      char* at = put_point(out.room(max_object), p, record.scan.model->turn_deg);
      at = put_text(at, ",\"partial\":");
      at = put_bool(at, record.scan.is_partial());
      out.wrote(put_text(at, "}\n"));
    }
  }

 private:
  static constexpr std::size_t max_object = 384;

  char* put_point(char* position, const point& p, std::uint16_t turn_deg) const noexcept {
    position = digits::put_number(put_text(position, "{\"scan\":"), p.revolution);
    position = put_angle_column(put_text(position, ",\"angle_deg\":"), p, style_.to, turn_deg);
    position = put_range_column(put_text(position, range_name_), p, style_.unit);
    position = digits::put_number(put_text(position, ",\"time_ns\":"), p.time_ns);
    if (style_.intensity)
      position = digits::put_number(put_text(position, ",\"intensity\":"), p.intensity);
    if (style_.sample_flags) {
      position = digits::put_number(put_text(position, ",\"sample_flags\":"), p.sample_flags);
    }
    position = put_bool(put_text(position, ",\"no_return\":"), p.is_no_return());
    position = put_bool(put_text(position, ",\"too_near\":"), p.is_too_near());
    for (const doubt_name& each : doubts) {
      if (each.flag == point_flags::too_near || (p.flags & each.flag) == point_flags::none)
        continue;
      position = put_text(put_text(put_text(position, ",\""), each.name), "\":true");
    }
    return position;
  }

  text_style style_;
  std::string range_name_;
};

/// An object per revolution, with arrays of its points.
class jsonl_scans final : public point_writer {
 public:
  explicit jsonl_scans(const text_style& style) : style_(style) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return true; }

  void write_scan(const scan_record& record, text_sink& out) override {
    const scan& scan = record.scan;
    out.write("{\"scan\":" + std::to_string(scan.revolution) +
              ",\"partial\":" + (scan.is_partial() ? "true" : "false") + ",\"why\":[" +
              names_of(scan.flags, "\"", ",", "\"") +
              "],\"points\":" + std::to_string(scan.points.size()) +
              ",\"returns\":" + std::to_string(returns_in(scan.points)) +
              ",\"suspect_samples\":" + std::to_string(scan.suspect_samples) +
              ",\"turned_deg\":" + with_decimals(static_cast<double>(scan.turned_deg), 2) +
              ",\"reported_hz\":" + if_known(reported_hz(scan), 1, "null") +
              ",\"measured_hz\":" + if_known(record.measured_hz, 3, "null"));
    write_column(scan, "angle_deg", out, [&](char* position, const point& p) {
      return put_angle_column(position, p, style_.to, scan.model->turn_deg);
    });
    write_column(scan, style_.unit == length_unit::metres ? "range_m" : "range_mm", out,
                 [this](char* position, const point& p) {
                   return put_range_column(position, p, style_.unit);
                 });
    write_column(scan, "time_ns", out, [](char* position, const point& p) {
      return digits::put_number(position, p.time_ns);
    });
    if (style_.intensity) {
      write_column(scan, "intensity", out, [](char* position, const point& p) {
        return digits::put_number(position, p.intensity);
      });
    }
    if (style_.sample_flags) {
      write_column(scan, "sample_flags", out, [](char* position, const point& p) {
        return digits::put_number(position, p.sample_flags);
      });
    }
    out.write("}\n");
  }

 private:
  static constexpr std::size_t max_number = 48;

  template <class Put>
  static void write_column(const scan& scan, std::string_view name, text_sink& out,
                           const Put& put) {
    out.write(",\"");
    out.write(name);
    out.write("\":[");
    bool first = true;
    for (const point& p : scan.points) {
      char* at = out.room(max_number);
      if (!first) *at++ = ',';
      first = false;
      out.wrote(put(at, p));
    }
    out.write("]");
  }

  text_style style_;
};

}  // namespace

std::unique_ptr<point_writer> make_jsonl_writer(const text_style& style) {
  if (style.scans) return std::make_unique<jsonl_scans>(style);
  return std::make_unique<jsonl_points>(style);
}

}  // namespace g4_tool
