// SPDX-License-Identifier: MIT
#include "g4lidar/export/point_writer.hpp"

#include "value_text.hpp"

namespace g4lidar {

text_sink::text_sink() : buffer_(new char[capacity]) {}
text_sink::~text_sink() = default;

void text_sink::write(std::string_view text) {
  while (!text.empty()) {
    const std::string_view part = text.substr(0, max_room);
    wrote(digits::put_text(room(part.size()), part));
    text.remove_prefix(part.size());
  }
}

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

}  // namespace g4lidar
