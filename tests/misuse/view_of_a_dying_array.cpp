// SPDX-License-Identifier: MIT
// A packet_view of a temporary array, also a const one, does not compile.
// expect: deleted function.*packet_view::from|call to deleted function 'from'
#include <array>
#include <cstdint>

#include "g4lidar/core/packet.hpp"

const std::array<std::uint8_t, 12> read_a_packet();

bool misuse() {
#ifdef MISUSE
  const auto packet = g4lidar::packet_view::from(read_a_packet());
#else
  const auto& data = read_a_packet();
  const auto packet = g4lidar::packet_view::from(data);
#endif
  return packet.has_value();
}
