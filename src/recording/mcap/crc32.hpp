// SPDX-License-Identifier: MIT
// CRC-32 of MCAP, zlib and Ethernet.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "g4lidar/core/bytes.hpp"

namespace g4lidar::mcap {

namespace crc_detail {

inline constexpr std::size_t stride = 16;

/// Table k has the effect of a byte on the sum when k more bytes follow: sixteen bytes at a time.
consteval std::array<std::array<std::uint32_t, 256>, stride> make_tables() {
  std::array<std::array<std::uint32_t, 256>, stride> tables{};
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

/// The effect of eight bytes on the sum when `after` more follow.
template <std::size_t after>
[[nodiscard]] constexpr std::uint32_t of_eight(std::uint64_t data) noexcept {
  const auto of = [data](std::size_t byte) {
    return tables[after + 7 - byte][static_cast<std::uint8_t>(data >> (8 * byte))];
  };
  return of(0) ^ of(1) ^ of(2) ^ of(3) ^ of(4) ^ of(5) ^ of(6) ^ of(7);
}

}  // namespace crc_detail

/// An incremental checksum. *Never allocates.*
class crc32 {
 public:
  constexpr void add(bytes data) noexcept {
    using namespace crc_detail;
    std::uint32_t sum = state_;
    for (; data.size() >= stride; data = data.subspan(stride)) {
      sum = of_eight<8>(load_u64(data, 0) ^ sum) ^ of_eight<0>(load_u64(data, 8));
    }
    for (const std::uint8_t byte : data) sum = (sum >> 8U) ^ tables[0][(sum ^ byte) & 0xFFU];
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
