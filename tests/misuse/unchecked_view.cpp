// SPDX-License-Identifier: MIT
// A packet_view of unchecked bytes cannot be created.
// expect: is private within this context|calling a private constructor
#include "g4lidar/core/packet.hpp"

bool misuse(g4lidar::bytes data) {
#ifdef MISUSE
  const g4lidar::packet_view packet(data, g4lidar::g4_layout);
  return packet.is_zero();
#else
  const auto packet = g4lidar::packet_view::from(data);
  return packet && packet->is_zero();
#endif
}
