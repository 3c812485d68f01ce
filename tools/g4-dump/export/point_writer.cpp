// SPDX-License-Identifier: MIT
#include "point_writer.hpp"

#include "value_text.hpp"

namespace g4_tool {

point_writer::~point_writer() = default;
void point_writer::begin(text_sink&) {}
void point_writer::write_points(std::span<const point>, text_sink&) {}
void point_writer::write_scan(const scan_record&, text_sink&) {}

std::unique_ptr<point_writer> make_point_writer(const text_style& style) {
  switch (style.format) {
    case text_format::csv:
      return make_csv_writer(style);
    case text_format::jsonl:
      return make_jsonl_writer(style);
    case text_format::text:
      break;
  }
  return make_text_writer(style);
}

}  // namespace g4_tool
