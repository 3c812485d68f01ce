// SPDX-License-Identifier: MIT
// A packet may give several scans and is passed repeatedly: a temporary packet does not compile.
// expect: (cannot bind|no matching member function|no known conversion|expects an lvalue)
#include <array>

#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/scan_assembler.hpp"

bool misuse(g4lidar::scan_assembler& assembler, g4lidar::packet_view packet,
            std::array<g4lidar::point, g4lidar::max_samples>& out) {
#ifdef MISUSE
  return assembler.next(decode(packet, g4lidar::exact_correction{}, 0, out)).has_value();
#else
  g4lidar::decoded points = decode(packet, g4lidar::exact_correction{}, 0, out);
  return assembler.next(points).has_value();
#endif
}
