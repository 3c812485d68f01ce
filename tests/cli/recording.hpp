// SPDX-License-Identifier: MIT
// Small recordings made by hand, a piece at a time.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/core/bytes.hpp"
#include "support/packet_maker.hpp"

namespace cli {

inline std::string text_of(g4lidar::bytes data) { return {data.begin(), data.end()}; }

/// What a device sends when scanning starts.
inline std::string scan_started() { return std::string("\xA5\x5A\x05\x00\x00\x40\x81", 7); }

/// A packet from one first-level angle to another, in degrees.
inline std::string packet(double first_deg, double last_deg,
                          const std::vector<std::uint16_t>& samples, unsigned ct = 0) {
  const g4lidar::made::packet made(ct, static_cast<int>(first_deg * 64.0),
                                   static_cast<int>(last_deg * 64.0), samples);
  return text_of(made.data());
}

/// A zero packet.
inline std::string zero(double at_deg, std::uint16_t sample = 4000, unsigned frequency_dhz = 0) {
  return packet(at_deg, at_deg, {sample}, frequency_dhz << 1 | 1U);
}

/// The rest of a revolution behind a zero packet at 0 degrees: `packets` packets of 40 samples.
inline std::string turn(unsigned packets = 9) {
  std::string data;
  const double width = 360.0 / packets;
  const std::vector<std::uint16_t> samples(40, 4000);
  for (unsigned i = 0; i < packets; ++i) {
    data += packet(i * width + width / 41.0, (i + 1) * width - width / 41.0, samples);
  }
  return data;
}

/// The same bytes with the lowest bit of one of them turned over.
inline std::string damaged(std::string data, std::size_t at) {
  data[at] = static_cast<char>(data[at] ^ 1);
  return data;
}

/// A bit of everything: a beginning in mid-turn, samples of every kind, a stray byte, a suspect
/// packet, a revolution that ends too early, a packet cut off.
inline std::string small_recording() {
  return scan_started() + packet(350, 359, {0, 621, 4000, 65535}) + std::string(1, '\0') +
         zero(0, 1120, 70) + packet(1, 10, {4000, 0, 300}) + packet(20, 19, {4000, 4000}) +
         zero(0, 0, 70) + packet(1, 2, {8000, 8000}).substr(0, 12);
}

}  // namespace cli
