// SPDX-License-Identifier: MIT
// How long a reader tries to open a lidar, and when this time begins again.
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include "listening_reader.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

class DeviceWait : public ReaderListener {};

TEST_F(DeviceWait, Ends) {
  const auto begun = std::chrono::steady_clock::now();
  const background_reader& made = begin(port(), {.device_wait = 1200ms});
  ASSERT_TRUE(heard.wait_for_state("ended"));
  EXPECT_GE(std::chrono::steady_clock::now() - begun, 1200ms);
  ASSERT_TRUE(made.failed());
  EXPECT_EQ(*made.failed(), problem::no_port);
}

TEST_F(DeviceWait, BeginsAgainAfterTheMotorRested) {
  const lidar_options options{.device_wait = 6s};
  auto device = std::make_unique<sim::background_pty>(plug_in());
  begin(port(), options, {.starts_rested = true});
  for (int unplugs = 0; unplugs < 2; ++unplugs) {
    ASSERT_TRUE(heard.wait_for_state("resting"));
    if (unplugs > 0) std::this_thread::sleep_for(options.device_wait);
    device.reset();
    std::string next;
    ASSERT_TRUE(heard.wait([&] {
      next = heard.states.back();
      return next != "resting";
    }));
    ASSERT_EQ(next, "opening") << unplugs;
    device = std::make_unique<sim::background_pty>(plug_in());
  }
  EXPECT_TRUE(heard.wait_for_state("resting"));
}

TEST_F(DeviceWait, BeginsAgainAfterPointsWithoutAScan) {
  const auto begun = std::chrono::steady_clock::now();
  const lidar_options options{.device_wait = 6s};
  background_reader& made = begin("sim:?fault=unplug@400ms", options, {.wants_points = true});
  ASSERT_TRUE(heard.wait([&] {
    const bool has_ended = !heard.states.empty() && heard.states.back() == "ended";
    return has_ended || std::chrono::steady_clock::now() - begun > options.device_wait + 2s;
  }));
  EXPECT_FALSE(made.failed());
  made.stop();
  EXPECT_GE(heard.opened, 3);
  EXPECT_GT(heard.live_points, 0U);
  EXPECT_EQ(heard.number_of_scans(), 0U);
}

}  // namespace
}  // namespace g4lidar::test
