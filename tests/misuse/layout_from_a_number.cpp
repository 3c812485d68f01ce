// SPDX-License-Identifier: MIT
// The bytes of a sample are no layout: several layouts have the same size.
// expect: (no matching function|no known conversion|could not convert|cannot convert|cannot initialize)
#include "g4lidar/core/packet.hpp"

bool misuse(g4lidar::bytes data) {
#ifdef MISUSE
  return g4lidar::packet_size(40, 3) == data.size();
#else
  return g4lidar::packet_size(40, g4lidar::sample_layout::intensity_8) == data.size();
#endif
}
