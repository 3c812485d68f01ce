// SPDX-License-Identifier: MIT
// CRC-32 of MCAP, ZIP and Ethernet, by zlib.
#pragma once

#include <zlib.h>

#include <cstdint>

#include "g4lidar/core/bytes.hpp"

namespace g4lidar::mcap {

/// An incremental checksum. *Never allocates.*
class crc32 {
 public:
  void add(bytes data) noexcept {
    // Without an address zlib begins anew.
    if (!data.empty()) sum_ = static_cast<std::uint32_t>(crc32_z(sum_, data.data(), data.size()));
  }
  [[nodiscard]] std::uint32_t value() const noexcept { return sum_; }

 private:
  std::uint32_t sum_ = 0;
};

[[nodiscard]] inline std::uint32_t crc32_of(bytes data) noexcept {
  crc32 sum;
  sum.add(data);
  return sum.value();
}

}  // namespace g4lidar::mcap
