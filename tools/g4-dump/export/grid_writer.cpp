// SPDX-License-Identifier: MIT
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/grid.hpp"
#include "value_text.hpp"

namespace g4_tool {
namespace {

class grid_writer final : public point_writer {
 public:
  grid_writer(const text_style& style, std::size_t bins, const grid_options& options)
      : style_(style), how_(options), ranges_m_(bins) {
    how_.to = style.to;
  }

  [[nodiscard]] bool takes_scans() const noexcept override { return true; }

  void begin(text_sink& out) override {
    if (style_.format == text_format::jsonl) return;
    const std::string unit = name_of(style_.unit);
    if (style_.format == text_format::text) {
      return out.write("  scan  " + std::to_string(ranges_m_.size()) + " ranges in " + unit + "\n");
    }
    out.write("scan,time_ns,partial");
    for (std::size_t i = 0; i < ranges_m_.size(); ++i) {
      out.write(",range_" + unit + "_" + std::to_string(i));
    }
    out.write("\n");
  }

  void write_scan(const scan_record& record, text_sink& out) override {
    fill_grid(record.scan, ranges_m_, how_);
    const std::string scan = std::to_string(record.scan.revolution);
    const std::string time_ns = std::to_string(record.time_ns);
    const std::string partial = record.scan.is_partial() ? "true" : "false";
    switch (style_.format) {
      case text_format::csv:
        out.write(scan + "," + time_ns + "," + partial);
        write_ranges(out, ",", ",", {"inf", "nan", "-inf"});
        return out.write("\n");
      case text_format::jsonl:
        out.write("{\"scan\":" + scan + ",\"partial\":" + partial + ",\"time_ns\":" + time_ns +
                  ",\"angle_min_deg\":" + (style_.to == frame::robot ? "-180" : "0") +
                  ",\"angle_step_deg\":" + shortest(360.0 / static_cast<double>(ranges_m_.size())) +
                  ",\"ranges_" + name_of(style_.unit) + "\":[");
        write_ranges(out, "", ",", {"\"inf\"", "null", "\"-inf\""});
        return out.write("]}\n");
      case text_format::text:
        break;
    }
    out.write(in_column(6, scan) + " ");
    write_ranges(out, " ", " ", {"-", "?", "<"});
    out.write("\n");
  }

 private:
  /// What is written for +infinity, NaN and -infinity.
  struct no_numbers {
    std::string_view no_return;
    std::string_view unknown;
    std::string_view too_near;
  };

  void write_ranges(text_sink& out, std::string_view before, std::string_view between,
                    const no_numbers& words) const {
    std::string_view mark = before;
    for (const float range_m : ranges_m_) {
      out.write(mark);
      mark = between;
      if (std::isnan(range_m)) {
        out.write(words.unknown);
      } else if (std::isinf(range_m)) {
        out.write(range_m > 0 ? words.no_return : words.too_near);
      } else {
        out.wrote(put_range(out.room(48), static_cast<double>(range_m)));
      }
    }
  }

  char* put_range(char* out, double range_m) const noexcept {
    if (style_.unit == length_unit::metres) return digits::put_fixed<5>(out, range_m);
    return digits::put_fixed<2>(out, range_m * 1000.0);
  }

  text_style style_;
  grid_options how_;
  std::vector<float> ranges_m_;
};

}  // namespace

std::unique_ptr<point_writer> make_grid_writer(const text_style& style, std::size_t bins,
                                               const grid_options& options) {
  return std::make_unique<grid_writer>(style, bins, options);
}

}  // namespace g4_tool
