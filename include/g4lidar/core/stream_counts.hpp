// SPDX-License-Identifier: MIT
// Counts of the contents of a stream; they are consistent at every moment.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "g4lidar/core/skipped.hpp"

namespace g4lidar {

/// Counts over a stream. At every moment the bytes given to the parser are
/// parsed_bytes + skipped_bytes() + the parser's held(). A stream_counter counts them.
struct stream_counts {
  std::uint64_t parsed_bytes = 0;  ///< Of all packets and responses.
  std::uint64_t packets = 0;       ///< Valid packets, including suspect ones.
  std::uint64_t responses = 0;     ///< Valid responses.
  std::uint64_t points = 0;        ///< Samples of packets that are not suspect.
  std::uint64_t suspect = 0;       ///< Packets whose samples have no known angles.
  std::uint64_t time_packets = 0;  ///< Valid time packets.
  std::uint64_t empty_packets =
      0;  ///< Valid packets without samples, which `packets` does not count.
  std::uint64_t crc_matches =
      0;  ///< Revolutions that are complete by the CRC of a device; see ct_check.
  std::uint64_t crc_mismatches = 0;  ///< Revolutions that lost a packet, by that CRC.
  std::array<std::uint64_t, skip_reasons> skipped_by_reason{};  ///< Bytes.

  /// Bytes skipped for `reason`; 0 for a number that is none.
  [[nodiscard]] constexpr std::uint64_t skipped(skip_reason reason) const noexcept {
    const auto at = static_cast<std::size_t>(reason);
    return at < skip_reasons ? skipped_by_reason[at] : 0;
  }
  /// Bytes skipped for any reason.
  [[nodiscard]] constexpr std::uint64_t skipped_bytes() const noexcept {
    std::uint64_t sum = 0;
    for (const std::uint64_t count : skipped_by_reason) sum += count;
    return sum;
  }

  friend constexpr bool operator==(const stream_counts&, const stream_counts&) = default;
};

}  // namespace g4lidar
