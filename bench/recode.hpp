// SPDX-License-Identifier: MIT
// The packets of a simulated G4 in the layouts of other models.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/packet.hpp"

namespace g4lidar::bench {

/// The word of a range that a G4 sends as `raw`, in another layout.
[[nodiscard]] inline unsigned range_word_of(std::uint16_t raw, sample_layout layout) noexcept {
  const int units = range_units_per_mm(layout);
  if (units != 4) return raw * static_cast<unsigned>(units) / 4U;
  return layout == sample_layout::quarter_mm ? raw : raw & 0xFFFCU;
}

/// The packets of `g4`, as a device of the model `which` would send them: the same angles and ranges.
[[nodiscard]] inline std::vector<std::uint8_t> recoded(bytes g4, const model& which) {
  const sample_layout layout = which.samples.layout;
  std::vector<std::uint8_t> all;
  while (!g4.empty()) {
    const std::size_t samples = g4[3];
    assert(samples <= which.samples.max_samples);
    std::vector<std::uint8_t> one(g4.begin(), g4.begin() + packet_header_size);
    for (std::size_t i = 0; i < samples; ++i) {
      one.insert(one.end(), sample_size(layout) - 2, 0x55);
      const unsigned word = range_word_of(load_u16(g4, packet_size(i)), layout);
      one.push_back(static_cast<std::uint8_t>(word));
      one.push_back(static_cast<std::uint8_t>(word >> 8));
    }
    store_u16(one, 8, packet_checksum(one, layout));
    all.insert(all.end(), one.begin(), one.end());
    g4 = g4.subspan(packet_size(samples));
  }
  return all;
}

}  // namespace g4lidar::bench
