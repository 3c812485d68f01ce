// SPDX-License-Identifier: MIT
// The layout of decode() is chosen once for a stream, not by each packet.
// expect: (constant expression|not usable in a constant|non-type template argument|no matching function)
#include <array>

#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"

std::size_t misuse(g4lidar::packet_view packet) {
  std::array<g4lidar::point, g4lidar::max_samples> out;
  const g4lidar::exact_correction correction;
#ifdef MISUSE
  return g4lidar::decode<packet.layout()>(packet, correction, 0, out).points.size();
#else
  using g4lidar::sample_layout;
  return g4lidar::decode<sample_layout::whole_mm>(packet, correction, 0, out).points.size();
#endif
}
