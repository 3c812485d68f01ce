// SPDX-License-Identifier: MIT
// Packets for tests: any header and samples, with the matching checksum.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/packet.hpp"

namespace g4lidar::made {

/// A packet that owns its bytes.
class packet {
 public:
  /// `first_64ths` and `last_64ths` are in 1/64 degree, below 23040. All samples are 0 at first.
  constexpr packet(unsigned ct, int first_64ths, int last_64ths, std::size_t sample_count)
      : size_(packet_size(sample_count)) {
    bytes_[0] = 0xAA;
    bytes_[1] = 0x55;
    bytes_[2] = static_cast<std::uint8_t>(ct);
    bytes_[3] = static_cast<std::uint8_t>(sample_count);
    store_u16(bytes_, 4, static_cast<std::uint16_t>(2 * first_64ths + 1));
    store_u16(bytes_, 6, static_cast<std::uint16_t>(2 * last_64ths + 1));
    seal();
  }
  constexpr packet(unsigned ct, int first_64ths, int last_64ths,
                   std::span<const std::uint16_t> samples)
      : packet(ct, first_64ths, last_64ths, samples.size()) {
    for (std::size_t i = 0; i < samples.size(); ++i) store_u16(bytes_, 10 + 2 * i, samples[i]);
    seal();
  }

  constexpr packet& set(std::size_t i, std::uint16_t raw) {
    store_u16(bytes_, 10 + 2 * i, raw);
    seal();
    return *this;
  }

  [[nodiscard]] constexpr bytes data() const& { return bytes(bytes_).first(size_); }
  bytes data() const&& = delete;
  [[nodiscard]] constexpr packet_view view() const& { return *packet_view::from(data()); }
  packet_view view() const&& = delete;

 private:
  constexpr void seal() {
    unsigned sum = 0;
    for (std::size_t at = 0; at < size_; at += 2) {
      if (at != 8) sum ^= static_cast<unsigned>(bytes_[at] | bytes_[at + 1] << 8);
    }
    store_u16(bytes_, 8, static_cast<std::uint16_t>(sum));
  }

  std::array<std::uint8_t, max_packet_size> bytes_{};
  std::size_t size_;
};

/// A zero packet as real devices send it: one sample, FSA = LSA.
[[nodiscard]] constexpr packet zero(int angle_64ths, std::uint16_t raw = 4000,
                                    unsigned frequency_dhz = 0) {
  packet made(frequency_dhz << 1 | 1U, angle_64ths, angle_64ths, 1);
  return made.set(0, raw);
}

}  // namespace g4lidar::made
