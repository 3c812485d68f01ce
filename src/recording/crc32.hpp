// SPDX-License-Identifier: MIT
// CRC-32 as MCAP, zlib and Ethernet have it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "g4lidar/bytes.hpp"

namespace g4lidar::mcap {

namespace crc_detail {

/// Table k gives what a byte does to the sum when k more bytes follow: eight bytes at a time.
consteval std::array<std::array<std::uint32_t, 256>, 8> make_tables() {
  std::array<std::array<std::uint32_t, 256>, 8> tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t sum = byte;
    for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1U) ^ ((sum & 1U) != 0 ? 0xEDB88320U : 0U);
    tables[0][byte] = sum;
  }
  for (std::size_t k = 1; k < tables.size(); ++k) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t before = tables[k - 1][byte];
      tables[k][byte] = (before >> 8U) ^ tables[0][before & 0xFFU];
    }
  }
  return tables;
}
inline constexpr auto tables = make_tables();

}  // namespace crc_detail

/// A sum that grows. *Never allocates.*
class crc32 {
 public:
  constexpr void add(bytes data) noexcept {
    using crc_detail::tables;
    std::uint32_t sum = state_;
    std::size_t at = 0;
    for (; at + 8 <= data.size(); at += 8) {
      const std::uint32_t low = sum ^ load_u32(data, at);
      const std::uint32_t high = load_u32(data, at + 4);
      sum = tables[7][low & 0xFFU] ^ tables[6][(low >> 8U) & 0xFFU] ^
            tables[5][(low >> 16U) & 0xFFU] ^ tables[4][low >> 24U] ^ tables[3][high & 0xFFU] ^
            tables[2][(high >> 8U) & 0xFFU] ^ tables[1][(high >> 16U) & 0xFFU] ^
            tables[0][high >> 24U];
    }
    for (; at < data.size(); ++at) sum = (sum >> 8U) ^ tables[0][(sum ^ data[at]) & 0xFFU];
    state_ = sum;
  }
  [[nodiscard]] constexpr std::uint32_t value() const noexcept { return ~state_; }

 private:
  std::uint32_t state_ = 0xFFFFFFFFU;
};

[[nodiscard]] constexpr std::uint32_t crc32_of(bytes data) noexcept {
  crc32 sum;
  sum.add(data);
  return sum.value();
}

}  // namespace g4lidar::mcap
