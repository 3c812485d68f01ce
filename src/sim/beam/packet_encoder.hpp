// SPDX-License-Identifier: MIT
// The bytes of a point packet, written from the protocol and not from the parser.
#pragma once

#include <cstdint>
#include <span>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/sim/scanner.hpp"

namespace g4lidar::sim {

/// Writes a packet with these samples, at least one, whose angles are counted from `zero_deg`. Returns its
/// bytes in `out`.
[[nodiscard]] bytes encode_packet(std::span<std::uint8_t, longest_packet> out, std::uint8_t ct,
                                  std::span<const sample_truth> samples, const sample_code& code,
                                  double zero_deg) noexcept;

/// CRC-8 with the polynomial x^8 + x^5 + x^4 + 1, the lowest bit first, of one more byte.
[[nodiscard]] std::uint8_t crc_with(std::uint8_t crc, std::uint8_t byte) noexcept;

}  // namespace g4lidar::sim
