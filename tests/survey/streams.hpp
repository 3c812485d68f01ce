// SPDX-License-Identifier: MIT
// Bytes of simulated lidars that scan, in three worlds.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/device_options.hpp"
#include "g4lidar/sim/world.hpp"

namespace g4lidar::test {

using byte_list = std::vector<std::uint8_t>;

/// That of the simulator, an open place, and a long corridor.
inline std::vector<sim::world> some_worlds() {
  std::vector<sim::world> all{sim::built_in_world()};
  for (const std::string_view text : {"wall -900 900 900 900\nlidar 0 0 0\n",
                                      "wall -40 1.2 40 1.2\nwall -40 -2 40 -2\nlidar 0 0 0\n"}) {
    all.push_back(std::get<sim::world>(sim::parse_world(text)));
  }
  return all;
}

/// The first bytes of a lidar that scans, at its usual rate.
inline byte_list stream_of(const model& which, const sim::world& scene, std::uint32_t seed,
                           std::size_t size) {
  constexpr std::int64_t longest_ns = 60'000'000'000;
  sim::device_options options;
  EXPECT_TRUE(sim::use_model(options, which.word));
  options.scanner.seed = seed;
  const std::array faults{sim::make_fault(sim::fault_kind::scanning)};
  sim::device simulated(scene, options, faults);
  simulated.host().set_baud(which.bauds[0], 0);
  byte_list all;
  std::array<std::uint8_t, 4096> some{};
  for (std::int64_t now_ns = 0; now_ns < longest_ns && all.size() < size; now_ns += 1'000'000) {
    const std::size_t count = simulated.read(some, now_ns);
    all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(count));
  }
  EXPECT_GE(all.size(), size) << which.word;
  all.resize(size);
  return all;
}

}  // namespace g4lidar::test
