// SPDX-License-Identifier: MIT
// How long a reader tries to open a lidar, and when this time begins again.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "g4lidar/transport/transport.hpp"
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

/// What another attempt cannot change.
constexpr std::array lasting{problem::bad_option,   problem::not_serial,   problem::bad_baud_rate,
                             problem::other_device, problem::bad_setting,  problem::read_only,
                             problem::bad_file,     problem::end_of_input, problem::cancelled,
                             problem::system,       problem::not_supported};

/// The first attempt fails so.
struct once_failing {
  std::function<result<std::unique_ptr<connector>>(std::unique_ptr<connector>)> wrap() {
    return [this](std::unique_ptr<connector> from) -> result<std::unique_ptr<connector>> {
      if (++attempts == 1) return failure(task::opening, what, "a port");
      return from;
    };
  }
  problem what;
  std::atomic<int> attempts = 0;
};

TEST(MayPass, IsTheSameRuleForOpenAndAReader) {
  std::vector<std::thread> all;
  for (std::size_t i = 0; i < problem_count; ++i) {
    all.emplace_back([what = static_cast<problem>(i)] {
      const bool passes = std::ranges::find(lasting, what) == lasting.end();
      EXPECT_EQ(error(task::opening, what).may_pass(), passes) << name_of(what);
      once_failing by_open{what};
      const auto opened =
          lidar::open({.device = "sim:", .device_wait = patience, .wrap = by_open.wrap()});
      EXPECT_EQ(opened.has_value(), passes) << name_of(what);
      EXPECT_EQ(by_open.attempts, passes ? 2 : 1) << name_of(what);
      once_failing by_reader{what};
      reader_record heard;
      background_reader made({.device = "sim:", .device_wait = patience, .wrap = by_reader.wrap()},
                             {.starts_rested = true}, &heard);
      EXPECT_TRUE(made.start());
      EXPECT_TRUE(heard.wait_for_state(passes ? "resting" : "ended")) << name_of(what);
      EXPECT_EQ(by_reader.attempts, passes ? 2 : 1) << name_of(what);
    });
  }
  for (std::thread& each : all) each.join();
}

}  // namespace
}  // namespace g4lidar::test
