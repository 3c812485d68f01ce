// SPDX-License-Identifier: MIT
// Readers refer to the address of their ring: a ring cannot be copied or moved.
// expect: deleted (function|constructor)
#include "g4lidar/core/point_ring.hpp"

std::uint64_t misuse(g4lidar::point_ring<64>& ring) {
#ifdef MISUSE
  const g4lidar::point_ring<64> mine(ring);
#else
  const g4lidar::point_ring<64>& mine = ring;
#endif
  return mine.written();
}
