// SPDX-License-Identifier: MIT
#include "grid_writer.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "digits.hpp"
#include "g4lidar/grid.hpp"
#include "scan_summary.hpp"

namespace g4_dump {
namespace {

class grid_writer final : public point_writer {
 public:
  grid_writer(const point_style& style, std::size_t bins) : style_(style), ranges_m_(bins) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return true; }

  void begin(output& out) override {
    if (style_.format == text_format::jsonl) return;
    if (style_.format == text_format::text) {
      return out.write(
          fmt::format("  scan  {} ranges in {}\n", ranges_m_.size(), style_.unit_name()));
    }
    out.write("scan,time_ns,partial");
    for (std::size_t i = 0; i < ranges_m_.size(); ++i) {
      out.write(fmt::format(",range_{}_{}", style_.unit_name(), i));
    }
    out.write("\n");
  }

  void write_scan(const shown_scan& shown, output& out) override {
    g4lidar::fill_grid(shown.scan.points, ranges_m_, {.to = style_.frame});
    switch (style_.format) {
      case text_format::csv:
        out.write(
            fmt::format("{},{},{}", shown.scan.revolution, shown.time_ns, shown.scan.is_partial()));
        write_ranges(out, ",", ",", "inf", "nan");
        return out.write("\n");
      case text_format::jsonl:
        out.write(fmt::format(
            R"({{"scan":{},"partial":{},"time_ns":{},"angle_min_deg":{},"angle_step_deg":{},"ranges_{}":[)",
            shown.scan.revolution, shown.scan.is_partial(), shown.time_ns,
            style_.frame == g4lidar::frame::robot ? -180 : 0,
            360.0 / static_cast<double>(ranges_m_.size()), style_.unit_name()));
        write_ranges(out, "", ",", "\"inf\"", "null");
        return out.write("]}\n");
      case text_format::text:
        break;
    }
    out.write(fmt::format("{:6} ", shown.scan.revolution));
    write_ranges(out, " ", " ", "-", "?");
    out.write("\n");
  }

 private:
  void write_ranges(output& out, std::string_view before, std::string_view between,
                    std::string_view no_return, std::string_view unknown) const {
    std::string_view mark = before;
    for (const float range_m : ranges_m_) {
      out.write(mark);
      mark = between;
      if (std::isnan(range_m)) {
        out.write(unknown);
      } else if (std::isinf(range_m)) {
        out.write(no_return);
      } else {
        out.wrote(put_range(out.room(48), static_cast<double>(range_m)));
      }
    }
  }

  char* put_range(char* at, double range_m) const noexcept {
    if (style_.unit == length_unit::metres) return put_fixed<5>(at, range_m);
    return put_fixed<2>(at, range_m * 1000.0);
  }

  point_style style_;
  std::vector<float> ranges_m_;
};

}  // namespace

std::unique_ptr<point_writer> make_grid_writer(const point_style& style, std::size_t bins) {
  return std::make_unique<grid_writer>(style, bins);
}

}  // namespace g4_dump
