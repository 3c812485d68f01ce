// SPDX-License-Identifier: MIT
// What a lidar has sent and a program has missed, in numbers.
#pragma once

#include <cstdint>

#include "g4lidar/core/stream_counts.hpp"

namespace g4lidar {

/// Counts since open(), over all reconnects. At every moment bytes == stream.parsed_bytes +
/// stream.skipped_bytes() + held.
struct lidar_counts {
  std::uint64_t bytes = 0;          ///< Parsed.
  std::uint64_t held = 0;           ///< Of an unfinished packet or response.
  stream_counts stream;             ///< Packets, points, skipped bytes by reason, ...
  std::uint64_t samples_lost = 0;   ///< Measured and never received, derived from the angles.
  std::uint64_t scans = 0;          ///< Revolutions that were completed.
  std::uint64_t partial_scans = 0;  ///< Pieces of revolutions.
  std::uint64_t scans_missed = 0;   ///< Not taken by next_scan() before the next one was complete.
  std::uint64_t points_missed = 0;  ///< Not returned by next_points(), if the program calls it.
  std::uint64_t command_retries = 0;  ///< Commands that had to be sent again.
  std::uint64_t reconnects = 0;       ///< How often the device was reconnected.
  std::int64_t largest_gap_ns = 0;    ///< Between two packets of one scan.
};

}  // namespace g4lidar
