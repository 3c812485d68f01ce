// SPDX-License-Identifier: MIT
// Packets of every layout of samples and their points, in double precision from the formulas and
// with the system's arctangent: without code of the library.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <ostream>
#include <string>
#include <string_view>
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

/// What a model sends.
[[nodiscard]] inline const wire_format& wire_format_of(std::string_view model) {
  return *std::ranges::find(wire_formats, model, &wire_format::model);
}

/// The bytes of revolutions, and their points.
struct family_revolutions {
  std::vector<std::uint8_t> data;
  std::vector<family_point> points;
};

/// So many revolutions: each is a zero packet of one sample at 0 degrees, with the byte CT `zero_ct`, then packets of
/// `in_packet` samples, a divisor of 360, from 0.5 degrees on in steps of a degree.
/// `sample(turn, packet, i)` gives the samples; the zero packet is packet 0.
template <class Sample>
[[nodiscard]] family_revolutions revolutions_of(const wire_format& how, unsigned revolutions,
                                                unsigned in_packet, unsigned zero_ct,
                                                const Sample& sample) {
  family_revolutions all;
  for (unsigned turn = 0; turn < revolutions; ++turn) {
    for (unsigned packet = 0; packet <= 360 / in_packet; ++packet) {
      const unsigned count = packet == 0 ? 1 : in_packet;
      const unsigned first = packet == 0 ? 0 : 64 * in_packet * (packet - 1) + 32;
      std::vector<wire_sample> samples;
      for (unsigned i = 0; i < count; ++i) samples.push_back(sample(turn, packet, i));
      const auto made =
          packet_of(how, packet == 0 ? zero_ct : 0, first, first + 64 * (count - 1), samples);
      all.data.insert(all.data.end(), made.begin(), made.end());
      for (unsigned i = 0; i < count; ++i) {
        all.points.push_back(point_of(how, first / 64.0 + i, samples[i]));
      }
    }
  }
  return all;
}

/// Revolutions of a T-mini at 7 Hz, in packets of 30 samples: 2000 mm, flags 2, intensity 100 + packet.
[[nodiscard]] inline std::vector<std::uint8_t> t_mini_stream(unsigned revolutions) {
  const auto sample = [](unsigned, unsigned packet, unsigned) {
    return wire_sample{100 + packet, 8002};
  };
  return revolutions_of(wire_format_of("t-mini"), revolutions, 30, 2 * 70 + 1, sample).data;
}

}  // namespace reference
