// SPDX-License-Identifier: MIT
// The purposes of the random streams of a simulated lidar. The numbers are part of the golden digests.
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
  garbage = 8,  // bytes at a wrong baud rate, to the device
  odometry_way = 9,
  odometry_turn = 10,
  line_to_host = 11,  // where the rates of host and device differ
  line_to_device = 12,
  faults = 100  // plus the index of the fault
};

[[nodiscard]] constexpr random_stream stream_for(std::uint64_t seed, purpose purpose,
                                                 std::uint64_t index = 0) noexcept {
  return random_stream(seed, static_cast<std::uint64_t>(purpose) + index);
}

}  // namespace g4lidar::sim
