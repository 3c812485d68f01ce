// SPDX-License-Identifier: MIT
// A reader must not outlive its ring: a reader of a temporary ring does not compile.
// expect: deleted (member )?function
#include "g4lidar/core/point_ring.hpp"

bool misuse() {
#ifdef MISUSE
  const auto reader = g4lidar::point_ring<64>().make_reader();
#else
  static g4lidar::point_ring<64> ring;
  const auto reader = ring.make_reader();
#endif
  return reader.ahead() == 0;
}
