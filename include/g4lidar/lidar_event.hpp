// SPDX-License-Identifier: MIT
// What happens to a lidar without a request of the program.
#pragma once

#include <cstdint>
#include <string_view>

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

}  // namespace g4lidar
