// SPDX-License-Identifier: MIT
// What the random streams of a simulated G4 are for. The numbers are part of the golden digests.
#pragma once

#include <cstdint>

#include "g4lidar/sim/random.hpp"

namespace g4lidar::sim {

enum class purpose : std::uint64_t {
  start_angle = 1,
  noise = 2,
  dropouts = 3,
  motor = 4,
  phases = 5,  // of the head at each start
  strays = 6,
  batches = 7,
  garbage = 8,  // of a wrong baud rate, to the device
  faults = 100  // and the index of the fault
};

[[nodiscard]] constexpr random_stream stream_for(std::uint64_t seed, purpose what,
                                                 std::uint64_t which = 0) noexcept {
  return random_stream(seed, static_cast<std::uint64_t>(what) + which);
}

}  // namespace g4lidar::sim
