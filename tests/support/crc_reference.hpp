// SPDX-License-Identifier: MIT
// CRC-8/MAXIM in another form than in the library and in the simulated lidar.
#pragma once

#include <cstdint>
#include <span>

namespace reference {

/// Over the bytes with their bits mirrored, the most significant bit first, by the polynomial 0x31; the result
/// is mirrored back.
[[nodiscard]] constexpr std::uint8_t crc_8_maxim(std::span<const std::uint8_t> data) {
  const auto mirrored = [](unsigned byte) {
    unsigned made = 0;
    for (unsigned bit = 0; bit < 8; ++bit) made |= (byte >> bit & 1U) << (7 - bit);
    return made;
  };
  unsigned crc = 0;
  for (const std::uint8_t byte : data) {
    crc ^= mirrored(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc << 1U ^ ((crc & 0x80U) != 0 ? 0x31U : 0U)) & 0xFFU;
  }
  return static_cast<std::uint8_t>(mirrored(crc));
}

}  // namespace reference
