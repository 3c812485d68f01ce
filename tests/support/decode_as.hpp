// SPDX-License-Identifier: MIT
// Decodes a packet of any model with the template for its layout and its correction.
#pragma once

#include <cstdint>
#include <span>

#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/packet.hpp"

namespace g4lidar::test {

template <class Form>
decoded decode_as(packet_view packet, const Form& form, std::span<point, max_samples> out,
                  std::uint16_t shortest_mm) {
  switch (packet.layout()) {
    case sample_layout::quarter_mm:
      return decode<sample_layout::quarter_mm>(packet, form, 0, out, shortest_mm);
    case sample_layout::flagged_mm:
      return decode<sample_layout::flagged_mm>(packet, form, 0, out, shortest_mm);
    case sample_layout::half_mm:
      return decode<sample_layout::half_mm>(packet, form, 0, out, shortest_mm);
    case sample_layout::whole_mm:
      return decode<sample_layout::whole_mm>(packet, form, 0, out, shortest_mm);
    case sample_layout::intensity_10:
      return decode<sample_layout::intensity_10>(packet, form, 0, out, shortest_mm);
    case sample_layout::intensity_8:
      return decode<sample_layout::intensity_8>(packet, form, 0, out, shortest_mm);
    case sample_layout::intensity_16:
      return decode<sample_layout::intensity_16>(packet, form, 0, out, shortest_mm);
  }
  return {};
}
inline decoded decode_as(packet_view packet, const model& which,
                         std::span<point, max_samples> out) {
  const std::uint16_t shortest_mm = which.range.min_mm;
  switch (which.samples.correction) {
    case correction_kind::triangle:
      return decode_as(packet, compact_correction{}, out, shortest_mm);
    case correction_kind::scl:
      return decode_as(packet, scl_correction{}, out, shortest_mm);
    case correction_kind::none:
      return decode_as(packet, no_correction{}, out, shortest_mm);
  }
  return {};
}

}  // namespace g4lidar::test
