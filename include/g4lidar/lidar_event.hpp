// SPDX-License-Identifier: MIT
// What happens to a lidar without a request of the program, and what it has sent and the program has missed, in numbers.
#pragma once

#include <cstdint>
#include <string_view>

#include "g4lidar/core/stream_counts.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"

namespace g4lidar {

/// Something that happened without a request of the caller.
struct lidar_event {
  /// The kinds of event; docs/symptoms.md describes what to do about each.
  enum class kind : std::uint8_t {
    lost,            ///< The connection was lost; `reason` has the cause.
    reconnected,     ///< The same device is back, with the same settings and state as before.
    found_scanning,  ///< It was scanning although it had not been started; it was stopped.
    protection_starved,  ///< The keep-alive was sent too late and the protection stopped the scan; started again.
    protection_found_on,  ///< The protection was on unexpectedly: started again, and kept alive.
    spinning_up,          ///< Started, and no point has come yet: the motor spins up.
    restarted,            ///< The scan had ended by itself; the device is set and started again.
    health_warning,       ///< The device reports a warning when it is started.
    other_lidar,  ///< While the lidar was lost, another one answered; it received no further commands.
    long_pause,  ///< The next data of a recording follows in more than a minute.
    overflow,    ///< Earlier events were dropped, because next_event() was not called.
    /// stop() has ended the scans, but the motor turns. Where the line DTR drives it, close() stops it; else
    /// nothing does.
    still_turning,
    /// Points come without the offset of zero that their model has: command 93 was not answered, or the bytes or the
    /// recording do not have the answer. The angles are those of the device. Asked again at each start.
    no_zero_angle,
    /// The lidar states a number that its model does not have, but that names no other model surely: that of
    /// information().
    other_number,
  };
  kind what;
  problem reason;        ///< Of `lost`; else problem::timeout, without a meaning.
  std::int64_t time_ns;  ///< When, by the monotonic clock.
};

/// The name of the event in tools and documents. Valid forever.
[[nodiscard]] G4LIDAR_API std::string_view name_of(lidar_event::kind what) noexcept;

/// Counts since open(), over all reconnects. At every moment bytes == stream.parsed_bytes +
/// stream.skipped_bytes() + held.
struct lidar_counts {
  std::uint64_t bytes = 0;            ///< Parsed.
  std::uint64_t held = 0;             ///< Of an unfinished packet or response.
  stream_counts stream;               ///< Packets, points, skipped bytes by reason, ...
  std::uint64_t samples_lost = 0;     ///< Measured and never received, derived from the angles.
  std::uint64_t scans = 0;            ///< Revolutions that were completed.
  std::uint64_t partial_scans = 0;    ///< Pieces of revolutions.
  std::uint64_t scans_missed = 0;     ///< Not taken by try_scan() before the next one was complete.
  std::uint64_t points_missed = 0;    ///< Not returned by next_points(), if the program calls it.
  std::uint64_t command_retries = 0;  ///< Commands that had to be sent again.
  std::uint64_t reconnects = 0;       ///< How often the device was reconnected.
  std::int64_t largest_gap_ns = 0;    ///< Between two packets of one scan.
};

}  // namespace g4lidar
