// SPDX-License-Identifier: MIT
// A packet_view of temporary bytes would dangle: it does not compile.
// expect: deleted function.*packet_view::from|call to deleted function 'from'
#include <array>
#include <cstdint>
#include <vector>

#include "g4lidar/core/packet.hpp"

std::vector<std::uint8_t> read_a_packet();

bool misuse() {
#ifdef MISUSE
  const auto packet = g4lidar::packet_view::from(read_a_packet());
#else
  const std::vector<std::uint8_t> data = read_a_packet();
  const auto packet = g4lidar::packet_view::from(data);
#endif
  return packet.has_value();
}
