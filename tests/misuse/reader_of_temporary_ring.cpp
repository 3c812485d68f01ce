// SPDX-License-Identifier: MIT
// A reader does not outlive its ring: one of a ring that dies with the statement does not compile.
// expect: deleted (member )?function
#include "g4lidar/point_ring.hpp"

bool misuse() {
#ifdef MISUSE
  const auto reader = g4lidar::point_ring<64>().make_reader();
#else
  static g4lidar::point_ring<64> ring;
  const auto reader = ring.make_reader();
#endif
  return reader.ahead() == 0;
}
