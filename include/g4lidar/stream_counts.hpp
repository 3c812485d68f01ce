// SPDX-License-Identifier: MIT
// What has come out of a stream so far, in numbers that always add up.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>

#include "g4lidar/packet.hpp"
#include "g4lidar/response.hpp"
#include "g4lidar/stream_parser.hpp"

namespace g4lidar {

/// How many reasons for a skip there are.
inline constexpr std::size_t skip_reasons = 4;

/// Counts over a stream. At every moment the bytes given to the parser are
/// frame_bytes + skipped_bytes() + the parser's held().
struct stream_counts {
  std::uint64_t frame_bytes = 0;
  std::uint64_t packets = 0;    ///< Valid packets, the suspect ones too.
  std::uint64_t responses = 0;  ///< Valid replies.
  std::uint64_t points = 0;     ///< Samples of packets that are not suspect.
  std::uint64_t suspect = 0;    ///< Packets from which no points can be told.
  std::array<std::uint64_t, skip_reasons> skipped_by_reason{};  ///< Bytes.

  /// Bytes skipped for `reason`.
  [[nodiscard]] constexpr std::uint64_t skipped(skip_reason reason) const noexcept {
    return skipped_by_reason[static_cast<std::size_t>(reason)];
  }
  /// Bytes skipped for any reason.
  [[nodiscard]] constexpr std::uint64_t skipped_bytes() const noexcept {
    std::uint64_t sum = 0;
    for (const std::uint64_t count : skipped_by_reason) sum += count;
    return sum;
  }

  /// Counts what a stream gave, each thing once: a valid packet, suspect or not,
  constexpr void add(packet_view packet) noexcept {
    frame_bytes += packet.data().size();
    ++packets;
    if (packet.is_suspect()) {
      ++suspect;
    } else {
      points += packet.sample_count();
    }
  }
  /// a valid reply,
  constexpr void add(response_view response) noexcept {
    frame_bytes += response.data().size();
    ++responses;
  }
  /// bytes that were skipped,
  constexpr void add(g4lidar::skipped gone) noexcept {
    skipped_by_reason[static_cast<std::size_t>(gone.reason)] += gone.count;
  }
  /// or whichever of them `found` is.
  constexpr void add(const event& found) noexcept {
    if (const auto* packet = std::get_if<packet_view>(&found)) return add(*packet);
    if (const auto* response = std::get_if<response_view>(&found)) return add(*response);
    if (const auto* gone = std::get_if<g4lidar::skipped>(&found)) add(*gone);
  }

  friend constexpr bool operator==(const stream_counts&, const stream_counts&) = default;
};

/// The name of a reason as the tools write it; it lives for ever.
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

}  // namespace g4lidar
