// SPDX-License-Identifier: MIT
// What happened on a line beside the bytes that came: what a recording keeps of it, and plays again.
#pragma once

#include <cstdint>
#include <string_view>

#include "g4lidar/bytes.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/export.hpp"

namespace g4lidar {

/// One thing that happened between two readings of a line. A view, as good as the call that gives it
/// says.
///
/// A driver that reads a recording does with its bytes what the driver did that was recorded, at the
/// same places; so the same points come out. A place is told by what had been made of the last reading
/// by then: `events` were taken from it, and `unparsed` of its bytes were left.
struct line_note {
  /// What can happen on a line.
  enum class kind : std::uint8_t {
    opened,  ///< The line was opened, the first time or again: `line`, `baud`.
    closed,  ///< It was given free, or it broke off: `reason`.
    sent,    ///< `data` was sent to the device.
    begun,   ///< The points that follow begin anew: `samples_per_second`, `delivers`.
    held,    ///< From here on packets make no points, until points have begun again.
    cut,     ///< What was unparsed was thrown away, and a frame that was held was taken apart.
    gap,     ///< Here bytes are missing from the recording.
    state,   ///< How things stand, told again for readers that join here: all of the above.
  };
  kind what;
  problem reason = problem::cancelled;   ///< Of `closed`; cancelled: nothing was wrong.
  bool delivers = true;                  ///< Whether packets make points from here on.
  std::uint32_t baud = 0;                ///< As transport::baud().
  std::uint32_t samples_per_second = 0;  ///< Nominally.
  std::uint32_t unparsed = 0;            ///< Bytes of the last reading.
  std::uint32_t events = 0;              ///< Of the parser, since the last reading.
  std::int64_t time_ns = 0;              ///< When, by the clock of the line.
  std::string_view line{};               ///< transport::name(), of `opened` and `state`.
  bytes data{};                          ///< Of `sent`.
};

/// The words of the tools and documents; they live for ever.
[[nodiscard]] G4LIDAR_API std::string_view name_of(line_note::kind what) noexcept;

}  // namespace g4lidar
