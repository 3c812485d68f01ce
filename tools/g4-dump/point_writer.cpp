// SPDX-License-Identifier: MIT
// Picks the writer of a format.
#include "point_writer.hpp"

namespace g4_dump {

std::unique_ptr<point_writer> make_point_writer(const point_style& style) {
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

}  // namespace g4_dump
