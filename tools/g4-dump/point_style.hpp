// SPDX-License-Identifier: MIT
// What of the points is written, and how.
#pragma once

#include <cstdint>

#include "g4lidar/point.hpp"

namespace g4_dump {

enum class text_format : std::uint8_t { csv, jsonl, text };

enum class length_unit : std::uint8_t { millimetres, metres };

struct point_style {
  text_format format = text_format::csv;
  bool scans = false;       ///< A record for each revolution, not for each point.
  bool valid_only = false;  ///< Without the points from which nothing came back.
  std::uint32_t rate_hz = 9000;

  // Of points that were shaped; see point_shaper.
  g4lidar::frame frame = g4lidar::frame::vendor;  ///< That `angle_deg` is in, [0, 360).
  length_unit unit = length_unit::millimetres;
  bool as_they_come = false;  ///< jsonl: points without a word on their revolution, not yet over.
  unsigned time_width = 5;    ///< text: digits of the seconds for which there is room.

  [[nodiscard]] bool leaves_out(const g4lidar::point& p) const noexcept {
    return valid_only && p.is_no_return();
  }
  [[nodiscard]] const char* unit_name() const noexcept {
    return unit == length_unit::metres ? "m" : "mm";
  }
};

}  // namespace g4_dump
