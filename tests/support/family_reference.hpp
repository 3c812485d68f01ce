// SPDX-License-Identifier: MIT
// Packets of every layout of samples and their points, in double precision from the formulas and
// with the system's arctangent: without code of the library.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "support/reference_points.hpp"

namespace reference {

/// What a model sends: the bytes of a sample, and the formula of the correction.
struct wire_format {
  std::string model;
  int sample_bytes;
  double mm_per_unit;  ///< Of the range, without the lower bits if they are no part of it.
  int low_bits;        ///< Of the word of the range: 0 or 2.
  enum class meaning { range, flags, upper_intensity } low_meaning;
  char correction;  ///< T: 21.8 and 155.3; S: 17.8; -: none.
  int most_samples;
};

/// One model for each combination of layout and correction.
inline const std::vector<wire_format> wire_formats{
    {"g4", 2, 0.25, 0, wire_format::meaning::range, 'T', 80},
    {"x4", 2, 1.0, 2, wire_format::meaning::flags, 'T', 40},
    {"g6", 2, 0.5, 0, wire_format::meaning::range, 'T', 40},
    {"tg15", 2, 1.0, 0, wire_format::meaning::range, '-', 40},
    {"g2", 3, 1.0, 2, wire_format::meaning::upper_intensity, 'T', 40},
    {"s4b", 3, 1.0, 2, wire_format::meaning::flags, 'T', 40},
    {"scl", 3, 1.0, 2, wire_format::meaning::flags, 'S', 40},
    {"t-mini", 3, 1.0, 2, wire_format::meaning::flags, '-', 40},
    {"t-mini-plus-sh", 4, 1.0, 0, wire_format::meaning::range, '-', 40},
};

inline std::ostream& operator<<(std::ostream& out, const wire_format& which) {
  return out << which.model;
}

/// The bytes of a sample as two numbers.
struct wire_sample {
  unsigned before;  ///< The bytes before the word of the range.
  unsigned word;
};

/// A valid packet. Angles are in 1/64 of a degree.
[[nodiscard]] inline std::vector<std::uint8_t> packet_of(const wire_format& how, unsigned ct,
                                                         unsigned first, unsigned last,
                                                         const std::vector<wire_sample>& samples) {
  std::vector<std::uint8_t> made;
  unsigned sum = 0;
  const auto put = [&](unsigned word) {
    made.push_back(static_cast<std::uint8_t>(word % 256));
    made.push_back(static_cast<std::uint8_t>(word / 256));
    sum ^= word;
  };
  put(0x55AA);
  put(ct + 256 * static_cast<unsigned>(samples.size()));
  put(2 * first + 1);
  put(2 * last + 1);
  made.insert(made.end(), {0, 0});
  for (const wire_sample& each : samples) {
    if (how.sample_bytes == 3) {
      made.push_back(static_cast<std::uint8_t>(each.before));
      sum ^= each.before;
    }
    if (how.sample_bytes == 4) put(each.before);
    put(each.word);
  }
  made[8] = static_cast<std::uint8_t>(sum % 256);
  made[9] = static_cast<std::uint8_t>(sum / 256);
  return made;
}

struct family_point {
  double range_mm;   ///< 0: no return.
  double angle_deg;  ///< In [0, 360].
  unsigned intensity;
  unsigned flags;
};

/// The point of a sample at this first-level angle.
[[nodiscard]] inline family_point point_of(const wire_format& how, double first_level_deg,
                                           const wire_sample& sample) {
  const unsigned low = how.low_bits == 0 ? 0 : sample.word % 4;
  const unsigned units = how.low_bits == 0 ? sample.word : sample.word / 4;
  // The quarters of a G4 are ranges from 1 mm on.
  const bool no_return = units == 0 || (how.mm_per_unit == 0.25 && units < 4);
  const double d = no_return ? 0.0 : units * how.mm_per_unit;
  double turned = 0.0;
  if (how.correction == 'T') {
    turned = std::atan(no_return ? -21.8 / 155.3 : 21.8 * (155.3 - d) / (155.3 * d));
  }
  if (how.correction == 'S' && !no_return) turned = std::atan(17.8 / d);
  family_point made{d, into_circle(first_level_deg + turned * 180.0 / std::numbers::pi),
                    sample.before, 0};
  if (how.low_meaning == wire_format::meaning::flags) made.flags = low;
  if (how.low_meaning == wire_format::meaning::upper_intensity) made.intensity += 256 * low;
  return made;
}

}  // namespace reference
