// SPDX-License-Identifier: MIT
// A packet_view of an array that dies with the call, a const one too, does not compile.
// expect: deleted function.*packet_view::from|call to deleted function 'from'
#include <array>
#include <cstdint>

#include "g4lidar/packet.hpp"

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
