// SPDX-License-Identifier: MIT
// Builds the bytes of packets and responses for tests; the checksum is that of the reference, not
// of the library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "support/reference_parser.hpp"

namespace g4lidar::test {

using buffer = std::vector<std::uint8_t>;

inline void append_u16(buffer& out, unsigned value) {
  out.push_back(static_cast<std::uint8_t>(value & 0xFFU));
  out.push_back(static_cast<std::uint8_t>(value >> 8 & 0xFFU));
}

inline void append(buffer& out, const buffer& more) {
  out.insert(out.end(), more.begin(), more.end());
}

/// Writes the checksum of the other bytes to `packet`; the number of samples is its LSN.
inline void fix_checksum(buffer& packet) {
  const int sum = reference::checksum_of(reference::window(packet, 0));
  packet[8] = static_cast<std::uint8_t>(sum & 0xFF);
  packet[9] = static_cast<std::uint8_t>(sum >> 8);
}

/// A packet with these raw fields, including check bits, and a matching checksum. The fields may be
/// impossible.
[[nodiscard]] inline buffer packet_bytes(unsigned ct, unsigned fsa, unsigned lsa,
                                         const std::vector<std::uint16_t>& samples) {
  buffer out{0xAA, 0x55, static_cast<std::uint8_t>(ct), static_cast<std::uint8_t>(samples.size())};
  append_u16(out, fsa);
  append_u16(out, lsa);
  append_u16(out, 0);
  for (const std::uint16_t sample : samples) append_u16(out, sample);
  fix_checksum(out);
  return out;
}

/// An angle in 1/64 of a degree in the format of the protocol, with its check bit.
[[nodiscard]] constexpr unsigned wire_angle(unsigned sixty_fourths) {
  return sixty_fourths << 1 | 1U;
}

/// `n` samples, all different, none of them 0.
[[nodiscard]] inline std::vector<std::uint16_t> some_samples(std::size_t n, unsigned first = 4000) {
  std::vector<std::uint16_t> samples;
  for (std::size_t i = 0; i < n; ++i) {
    samples.push_back(static_cast<std::uint16_t>(first + 37 * i));
  }
  return samples;
}

/// A response: the seven bytes of its header and its content.
[[nodiscard]] inline buffer response_bytes(std::uint8_t length, std::uint8_t top_bits,
                                           std::uint8_t type, const buffer& content) {
  buffer out{0xA5, 0x5A, length, 0, 0, top_bits, type};
  append(out, content);
  return out;
}

}  // namespace g4lidar::test
