// SPDX-License-Identifier: MIT
// Counts what the stream parser finds.
#pragma once

#include <cstddef>
#include <variant>

#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/core/stream_counts.hpp"
#include "g4lidar/core/stream_parser.hpp"

namespace g4lidar {

/// Counts over a stream, with functions to add to them. *Single thread, never allocates.*
struct stream_counter : stream_counts {
  /// Counts what was found in a stream, each item once: a valid packet, suspect or not,
  constexpr void add(packet_view packet) noexcept {
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
  }
  /// skipped bytes,
  constexpr void add(g4lidar::skipped gone) noexcept {
    skipped_by_reason[static_cast<std::size_t>(gone.reason)] += gone.count;
  }
  /// what another counter counted,
  constexpr void add(const stream_counts& other) noexcept {
    parsed_bytes += other.parsed_bytes;
    packets += other.packets;
    responses += other.responses;
    points += other.points;
    suspect += other.suspect;
    for (std::size_t i = 0; i < skip_reasons; ++i) {
      skipped_by_reason[i] += other.skipped_by_reason[i];
    }
  }
  /// or an event with any of these.
  constexpr void add(const event& found) noexcept {
    if (const auto* packet = std::get_if<packet_view>(&found)) return add(*packet);
    if (const auto* response = std::get_if<response_view>(&found)) return add(*response);
    if (const auto* gone = std::get_if<g4lidar::skipped>(&found)) add(*gone);
  }
};

}  // namespace g4lidar
