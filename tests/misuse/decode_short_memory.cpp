// SPDX-License-Identifier: MIT
// decode() writes up to 80 points: memory of a known smaller size does not compile.
// expect: (no matching function|no known conversion|could not convert|cannot convert)
#include <array>

#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"

std::size_t misuse(g4lidar::packet_view packet) {
#ifdef MISUSE
  std::array<g4lidar::point, 40> out;
#else
  std::array<g4lidar::point, g4lidar::max_samples> out;
#endif
  return decode(packet, g4lidar::exact_correction{}, 0, out).points.size();
}
