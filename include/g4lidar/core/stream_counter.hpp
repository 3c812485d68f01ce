// SPDX-License-Identifier: MIT
// Counts what the stream parser finds.
#pragma once

#include <cstddef>
#include <variant>

#include "g4lidar/core/ct_information.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/core/stream_counts.hpp"
#include "g4lidar/core/stream_parser.hpp"

namespace g4lidar {

/// Counts over a stream, with functions to add to them. *Single thread, never allocates.*
struct stream_counter : stream_counts {
  /// Counts what was found in a stream, each item once: a valid packet, suspect or not,
  constexpr void add(packet_view packet) noexcept {
    crc.add(packet);
    if (crc.last() != ct_check::result::none) add(crc.last());
    parsed_bytes += packet.data().size();
    ++packets;
    if (packet.is_suspect()) {
      ++suspect;
    } else {
      points += packet.sample_count();
    }
  }
  /// a valid response,
  constexpr void add(response_view response) noexcept {
    parsed_bytes += response.data().size();
    ++responses;
    if (response.kind() == response_kind::scan_started) crc = {};
  }
  /// a valid time packet,
  constexpr void add(time_packet_view packet) noexcept {
    parsed_bytes += packet.data().size();
    ++time_packets;
  }
  /// a valid packet without samples,
  constexpr void add(empty_packet_view packet) noexcept {
    parsed_bytes += packet.data().size();
    ++empty_packets;
  }
  /// skipped bytes,
  constexpr void add(g4lidar::skipped gone) noexcept {
    crc.add(gone);
    const auto reason = static_cast<std::size_t>(gone.reason);
    skipped_by_reason[reason < skip_reasons ? reason : skip_reasons - 1] += gone.count;
  }
  /// what another counter counted,
  constexpr void add(const stream_counts& other) noexcept {
    parsed_bytes += other.parsed_bytes;
    packets += other.packets;
    responses += other.responses;
    points += other.points;
    suspect += other.suspect;
    time_packets += other.time_packets;
    empty_packets += other.empty_packets;
    crc_matches += other.crc_matches;
    crc_mismatches += other.crc_mismatches;
    for (std::size_t i = 0; i < skip_reasons; ++i) {
      skipped_by_reason[i] += other.skipped_by_reason[i];
    }
  }
  /// a revolution whose CRC byte was compared,
  constexpr void add(ct_check::result compared) noexcept {
    crc_matches += compared == ct_check::result::match;
    crc_mismatches += compared == ct_check::result::mismatch;
  }
  /// or an event with any of these.
  constexpr void add(const event& found) noexcept {
    if (const auto* packet = std::get_if<packet_view>(&found)) return add(*packet);
    if (const auto* response = std::get_if<response_view>(&found)) return add(*response);
    if (const auto* gone = std::get_if<g4lidar::skipped>(&found)) return add(*gone);
    if (const auto* packet = std::get_if<time_packet_view>(&found)) return add(*packet);
    if (const auto* packet = std::get_if<empty_packet_view>(&found)) add(*packet);
  }

  /// Of the stream; a new one begins with the scan header, and where the caller replaces it.
  ct_check crc;
};

}  // namespace g4lidar
