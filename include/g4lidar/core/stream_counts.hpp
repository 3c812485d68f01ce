// SPDX-License-Identifier: MIT
// The contents of a stream in numbers: what was skipped and why, and counts that are consistent at every moment.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "g4lidar/detail/api.hpp"

namespace g4lidar {

/// Why bytes were skipped.
enum class skip_reason : std::uint8_t {
  noise,  ///< Nothing begins here: boot text, and the bytes that devices send before zero packets.
  bad_header,    ///< The start of a packet or response that is impossible.
  bad_checksum,  ///< A complete packet or time packet by its header; a byte is damaged or missing.
  truncated,     ///< A packet or response that was incomplete at the end.
};
/// The number of reasons for a skip.
inline constexpr std::size_t skip_reasons = 4;

/// Bytes of the stream outside packets, responses and time packets.
struct skipped {
  std::size_t count;
  skip_reason reason;
  std::uint8_t last = 0;  ///< The last of these bytes.

  friend constexpr bool operator==(const skipped&, const skipped&) = default;
};

/// The name of a reason in the tools. Valid forever.
[[nodiscard]] constexpr const char* name_of(skip_reason reason) noexcept {
  switch (reason) {
    case skip_reason::noise:
      return "noise";
    case skip_reason::bad_header:
      return "bad_header";
    case skip_reason::bad_checksum:
      return "bad_checksum";
    case skip_reason::truncated:
      break;
  }
  return "truncated";
}

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
