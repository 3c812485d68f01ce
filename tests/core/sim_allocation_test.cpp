// SPDX-License-Identifier: MIT
// A simulated lidar allocates on construction only.
#include <gtest/gtest.h>

#include <cstddef>

#include "g4lidar/sim/scanner.hpp"
#include "support/allocation_count.hpp"

namespace {

using namespace g4lidar;

TEST(SimAllocation, NextPacketAllocatesNothing) {
  const sim::world world = sim::built_in_world();
  sim::scanner_options options;
  options.noise_mm = 5.0;
  options.dropout_ratio = 0.1;
  EXPECT_GT(test::allocations_in([&] { (void)sim::scanner(world, options); }), 0U);

  sim::scanner scanner(world, options);
  std::size_t samples = 0;
  EXPECT_EQ(test::allocations_in([&] {
              while (samples < 20'000) samples += scanner.next().samples.size();
            }),
            0U);
}

TEST(SimAllocation, NextPacketOfADrivingLidarAllocatesNothing) {
  sim::world world = sim::built_in_world();
  world.path = {{0, {world.lidar, {}}}, {2'000'000'000, {{1.0, 0.0, 180.0}, {}}}};
  world.discs = {{0.3, 2.0, 0.0, 2.0, 1.0, 1.0}};
  const sim::scanner original(world, {});
  sim::scanner scanner = original;  // a copy has all the room, too
  std::size_t samples = 0;
  EXPECT_EQ(test::allocations_in([&] {
              while (samples < 20'000) samples += scanner.next().samples.size();
            }),
            0U);
}

}  // namespace
