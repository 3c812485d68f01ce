// SPDX-License-Identifier: MIT
// A device that is given up gets a stop command, although nothing is received from it.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/virtual_port.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

TEST(GivenUp, GetsAStopCommand) {
  constexpr std::int64_t second = 1'000'000'000;
  // The connection from the device is broken; the one to the device is not.
  const std::array faults{sim::make_fault(sim::fault_kind::stall, 4 * second)};
  sim::device simulated(sim::built_in_world(), {}, faults);
  sim::virtual_clock clock;
  auto device = lidar::open(std::make_unique<sim::virtual_connector>(simulated, clock));
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->start());
  result<scan> got = device->try_scan(500ms);
  while (clock.now_ns() < 60 * second && (got || !got.error().is_fatal())) {
    got = device->try_scan(500ms);
  }
  ASSERT_FALSE(got);
  EXPECT_EQ(got.error().code(), problem::stalled);
  static_cast<void>(simulated.available(clock.now_ns() + second));
  EXPECT_FALSE(simulated.is_scanning());
  EXPECT_FALSE(simulated.motor_turns());
}

}  // namespace
}  // namespace g4lidar::test
