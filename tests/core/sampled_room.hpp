// SPDX-License-Identifier: MIT
// Bytes of a lidar in a room, with or without the information in CT bytes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/layout_recogniser.hpp"
#include "support/crc_reference.hpp"
#include "support/family_reference.hpp"

namespace g4lidar::test {

using byte_vector = std::vector<std::uint8_t>;

inline const model& recognised(const byte_vector& data, std::size_t piece = 4096) {
  layout_recogniser seen;
  for (std::size_t from = 0; from < data.size(); from += piece) {
    seen.take(bytes(data).subspan(from).first(std::min(piece, data.size() - from)));
  }
  seen.finish();
  return seen.most_likely();
}

inline recognised_by basis_of(const byte_vector& data) {
  layout_recogniser seen;
  seen.take(data);
  seen.finish();
  return seen.basis();
}

/// Bytes CT of a revolution as devices with information send them (family: CT information).
struct information {
  unsigned id = 0;
  unsigned dhz = 0;
  bool has_crc = true;
};

/// Revolutions of a room: a zero packet with one sample, and packets of 40.
class room {
 public:
  explicit room(std::string_view model) : how_(reference::wire_format_of(model)) {}

  information stated{};
  unsigned samples = 561;
  bool has_flags_alone = false;
  byte_vector reply;  ///< Before everything.

  [[nodiscard]] byte_vector of(unsigned revolutions) {
    byte_vector made = reply;
    for (unsigned turn = 0; turn < revolutions; ++turn) {
      byte_vector cts;
      const auto put = [&](unsigned index, unsigned from, unsigned count) {
        unsigned ct = index == 0 ? 2 * stated.dhz + 1 : 0;
        if (stated.id != 0 && index == 7) ct = 2 * (stated.id % 16);
        if (stated.id != 0 && index == 9) ct = 2 * (2023 - 2020) * 4;  // a year, a month, a day
        if (stated.id != 0 && index == 10) ct = 2 * 3 * 8;
        if (stated.id != 0 && index == 11) ct = 2 * 15 * 4;
        cts.push_back(static_cast<std::uint8_t>(ct));
        std::vector<reference::wire_sample> row;
        for (unsigned i = 0; i < count; ++i) row.push_back(sample_at(from + i));
        const unsigned step = 64 * 360 / samples;
        const byte_vector packet =
            reference::packet_of(how_, ct, from * step, (from + count - 1) * step, row);
        made.insert(made.end(), packet.begin(), packet.end());
      };
      put(0, 0, 1);
      for (unsigned at = 1, index = 1; at < samples; at += 40, ++index) {
        put(index, at, std::min(40U, samples - at));
      }
      if (stated.id != 0 && stated.has_crc) made.push_back(reference::crc_8_maxim(cts));
    }
    return made;
  }

 private:
  /// Ranges between 1 and 4 m, some of them missing.
  inline reference::wire_sample sample_at(unsigned i) {
    state_ = state_ * 1'664'525U + 1'013'904'223U;
    const unsigned noise = state_ >> 24U;
    if (i % 13 == 0) return {0, has_flags_alone ? 1 + 2 * (i % 2) : 0};
    const unsigned mm = 1000 + 3000 * (i % 200) / 200 + noise % 8;
    if (how_.low_bits == 2) return {noise, mm * 4 + (noise % 17 == 0 ? 1U : 0U)};
    return {noise * 7, static_cast<unsigned>(mm / how_.mm_per_unit) + noise % 4};
  }

  const reference::wire_format& how_;
  unsigned state_ = 1;
};

}  // namespace g4lidar::test
