// SPDX-License-Identifier: MIT
// The expected points of a packet, in double precision from the formulas of the manual and with the
// system's arctangent: without code of the library.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

namespace reference {

/// The upper 14 bits, without the two bits of flags, are 0 where nothing came back.
[[nodiscard]] inline bool is_no_return(unsigned raw) { return raw / 4 == 0; }

/// The second-level correction by the formula of the manual, in degrees; for no return, its limit.
[[nodiscard]] inline double correction_deg(std::uint16_t raw) {
  if (is_no_return(raw)) return std::atan(-21.8 / 155.3) * 180.0 / std::numbers::pi;
  const double d = raw / 4.0;
  return std::atan(21.8 * (155.3 - d) / (155.3 * d)) * 180.0 / std::numbers::pi;
}

[[nodiscard]] inline double into_circle(double degrees) {
  const double rest = std::fmod(degrees, 360.0);
  return rest < 0.0 ? rest + 360.0 : rest;
}

/// The smaller way between two directions, in degrees.
[[nodiscard]] inline double apart_deg(double a, double b) {
  const double way = std::fabs(into_circle(a) - into_circle(b));
  return way > 180.0 ? 360.0 - way : way;
}

struct sample {
  std::uint16_t raw;
  double range_mm;
  double first_level_deg;  ///< In [0, 360).
  double angle_deg;        ///< Corrected; in [0, 360].
};

/// The samples of a packet, or none if it is suspect.
[[nodiscard]] inline std::vector<sample> samples_of(std::span<const std::uint8_t> packet) {
  const auto word = [&](std::size_t at) { return packet[at] + 256 * packet[at + 1]; };
  const int count = packet[3];
  const double first = word(4) / 2 / 64.0;
  const double last = word(6) / 2 / 64.0;
  double way = last - first;
  if (last < first) {
    if (!(first > 270.0 && last < 90.0)) return {};
    way += 360.0;
  }
  std::vector<sample> result;
  for (int i = 0; i < count; ++i) {
    const auto raw = static_cast<std::uint16_t>(word(10 + 2 * static_cast<std::size_t>(i)));
    const double uncorrected = count == 1 ? first : first + way / (count - 1) * i;
    result.push_back({raw, is_no_return(raw) ? 0.0 : raw / 4.0, into_circle(uncorrected),
                      into_circle(uncorrected + correction_deg(raw))});
  }
  return result;
}

}  // namespace reference
