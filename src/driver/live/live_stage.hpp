// SPDX-License-Identifier: MIT
// The stages of a live device.
#pragma once

#include <cstdint>

namespace g4lidar {

/// In this order, which comparisons use:
///
///     stage        action                                next stage
///     -----------  ------------------------------------  --------------------------------------------
///     closed       none                                  -
///     lost         connects again, with growing pauses   identifying
///     identifying  queries the identity                  idle; preparing, if it was scanning before;
///                                                        lost, if it is another device
///     idle         the requests of the caller            preparing, by start(); stopping, by stop()
///     preparing    health, settings, start               scanning; idle, if the device refuses
///     scanning     reads                                 stopping, by stop(); preparing, if the device
///                                                        seems to have rebooted
///     stopping     stop; it may be woken                 idle, by stop(); preparing, by start()
///     breaking     decodes the received bytes            broken
///     broken       waits until the last scan is taken    lost; closed, if reconnecting is off
///
/// A connection that breaks in the stage identifying leads to lost or closed, in a later stage to breaking.
enum class live_stage : std::uint8_t {
  closed,
  lost,
  identifying,
  idle,
  preparing,
  scanning,
  stopping,
  breaking,
  broken
};

}  // namespace g4lidar
