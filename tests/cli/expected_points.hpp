// SPDX-License-Identifier: MIT
// The points of bytes, worked out in double precision and by another parser, and the points of a text.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "program.hpp"

namespace cli {

inline const std::string& simulated() {
  static const std::string bytes = run({"sim", "--seconds", "2", "--seed", "5"}).out;
  return bytes;
}

struct expected_point {
  std::uint64_t scan;
  double angle_deg;
  double range_mm;
};

/// docs/protocol.md, Point packets: header AA 55, CT, LSN, FSA, LSA, CS, then samples of 2 bytes. For
/// streams without damage: what is no packet is passed over, also a last packet that is cut off.
inline std::vector<expected_point> points_in(const std::string& bytes) {
  const auto word = [&bytes](std::size_t at) {
    return static_cast<unsigned char>(bytes[at]) + 256 * static_cast<unsigned char>(bytes[at + 1]);
  };
  std::vector<expected_point> points;
  std::uint64_t scan = 0;
  bool is_first = true;
  for (std::size_t at = 0; at + 10 <= bytes.size();) {
    if (word(at) != 0x55AA) {
      ++at;
      continue;
    }
    const int count = static_cast<unsigned char>(bytes[at + 3]);
    const std::size_t end = at + 10 + 2 * static_cast<std::size_t>(count);
    if (end > bytes.size()) break;
    const bool is_zero = (bytes[at + 2] & 1) != 0;
    if (is_zero && !is_first) ++scan;
    is_first = false;
    const double first = (word(at + 4) >> 1) / 64.0;
    const double last = (word(at + 6) >> 1) / 64.0;
    const double width = std::fmod(last - first + 360.0, 360.0);
    for (int i = 0; i < count; ++i) {
      const int raw = word(at + 10 + 2 * static_cast<std::size_t>(i));
      const double range_mm = raw < 4 ? 0.0 : raw / 4.0;  // less is flags without a return
      const double level = first + (count > 1 ? width / (count - 1) * i : 0.0);
      const double slope = range_mm == 0.0 ? -21.8 / 155.3  // as from infinitely far away
                                           : 21.8 * (155.3 - range_mm) / (155.3 * range_mm);
      const double turned = std::atan(slope) * 180.0 / std::numbers::pi;
      points.push_back({scan, std::fmod(level + turned + 720.0, 360.0), range_mm});
    }
    at = end;
  }
  return points;
}

/// A row of csv.
struct row {
  std::uint64_t scan = 0;
  double angle_deg = 0.0;
  double range = 0.0;
  std::int64_t time_ns = 0;
};

inline std::vector<row> rows_of(const std::string& csv, const std::string& unit = "mm") {
  std::vector<row> rows;
  std::istringstream text(csv);
  std::string header;
  std::getline(text, header);
  EXPECT_EQ(header, "scan,angle_deg,range_" + unit + ",time_ns");
  row r;
  char comma = 0;
  while (text >> r.scan >> comma >> r.angle_deg >> comma >> r.range >> comma >> r.time_ns) {
    rows.push_back(r);
  }
  return rows;
}

/// All of them, in order; angles to 1e-4 degrees, the rounding of the text and of float.
inline void expect_points(const std::vector<row>& rows, const std::vector<expected_point>& wanted) {
  ASSERT_EQ(rows.size(), wanted.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_EQ(rows[i].scan, wanted[i].scan) << i;
    ASSERT_EQ(rows[i].range, wanted[i].range_mm) << i;
    ASSERT_LT(std::abs(std::remainder(rows[i].angle_deg - wanted[i].angle_deg, 360.0)), 1e-4) << i;
  }
}

}  // namespace cli
