// SPDX-License-Identifier: MIT
// Turns of samples for tests of revolutions, and the short names of their flags.
#pragma once

#include <cstddef>
#include <ostream>
#include <vector>

#include "g4lidar/core/scan_assembler.hpp"
#include "support/packet_maker.hpp"
#include "support/scan_cutter.hpp"

namespace g4lidar {

// For GoogleTest's messages.
inline void PrintTo(scan_flags flags, std::ostream* out) {
  *out << "flags " << static_cast<unsigned>(flags);
}

namespace test {

inline constexpr scan_flags whole = scan_flags::none;
inline constexpr scan_flags start_missing = scan_flags::start_missing;
inline constexpr scan_flags end_missing = scan_flags::end_missing;
inline constexpr scan_flags data_lost = scan_flags::data_lost;
inline constexpr scan_flags turn_short = scan_flags::turn_short;
inline constexpr scan_flags start_by_angle = scan_flags::start_by_angle;
inline constexpr scan_flags end_by_angle = scan_flags::end_by_angle;
inline constexpr scan_flags crc_mismatch = scan_flags::crc_mismatch;

/// Feeds samples from `from_deg` on, 2 per degree and 20 per packet, up to but not including
/// `to_deg`, both multiples of 10; they may be beyond 360.
inline void turn(scan_cutter& cutter, int from_deg, int to_deg) {
  for (int deg = from_deg; deg < to_deg; deg += 10) {
    const int first = deg % 360 * 64;
    const made::packet packet(0x86, first, (first + 19 * 32) % 23040, 20);
    cutter.feed(packet.view());
  }
}
inline void zero(scan_cutter& cutter, int deg = 0, unsigned frequency_dhz = 0) {
  const made::packet packet = made::zero(deg * 64, 4000, frequency_dhz);
  cutter.feed(packet.view());
}
inline void suspect(scan_cutter& cutter, int deg, unsigned ct = 0, std::size_t samples = 20) {
  const made::packet packet(ct, deg * 64, deg * 64 - 30, samples);
  cutter.feed(packet.view());
}

/// The flags of all scans so far.
inline std::vector<scan_flags> marks_of(const scan_cutter& cutter) {
  std::vector<scan_flags> flags;
  for (const kept_scan& kept : cutter.scans()) flags.push_back(kept.view.flags);
  return flags;
}
inline std::vector<std::size_t> sizes_of(const scan_cutter& cutter) {
  std::vector<std::size_t> sizes;
  for (const kept_scan& kept : cutter.scans()) sizes.push_back(kept.points.size());
  return sizes;
}

using all_marks = std::vector<scan_flags>;
using all_sizes = std::vector<std::size_t>;

}  // namespace test
}  // namespace g4lidar
