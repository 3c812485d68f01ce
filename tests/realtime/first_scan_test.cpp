// SPDX-License-Identifier: MIT
// The first scan of a one-way lidar that turns already, on a pseudo-terminal.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "g4lidar/core/model.hpp"
#include "realtime/device_on_pty.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

class FirstScan : public testing::TestWithParam<const char*> {};

// The 80th percentile of 5 runs: two revolutions and 0.3 s.
TEST_P(FirstScan, OfALidarThatTurns_AfterTwoRevolutions) {
  const model* const which = model_named(GetParam());
  ASSERT_NE(which, nullptr);
  ASSERT_EQ(which->link, link_kind::one_way);
  sim::device_options options;
  ASSERT_TRUE(sim::use_model(options, which->word));
  test::device_on_pty simulated(options);
  std::uint32_t speed_mhz = 0;
  ASSERT_TRUE(test::comes_true([&] {
    std::uint32_t now_mhz = 0;
    simulated.with([&](const sim::device& device, std::int64_t now_ns) {
      now_mhz = device.motor_mhz(now_ns);
    });
    const bool is_steady = now_mhz > 0 && now_mhz == speed_mhz;
    speed_mhz = now_mhz;
    return is_steady;
  }));
  lidar_options wanted = test::patient_options(simulated.path());
  wanted.model = which;
  wanted.baud = which->bauds[0];
  const auto revolution = std::chrono::nanoseconds(1'000'000'000'000 / speed_mhz);
  test::expect_percentile_below(2 * revolution + 300ms, 80, 5, [&] {
    const auto begin = clock::now();
    auto device = lidar::open(wanted);
    EXPECT_TRUE(device) << device.error().message();
    EXPECT_TRUE(device && device->start() && device->next_scan(test::patience));
    return clock::now() - begin;
  });
}

INSTANTIATE_TEST_SUITE_P(Models, FirstScan,
                         testing::Values("x2", "x4-pro", "s2-pro", "scl", "tx20"));

}  // namespace
}  // namespace g4lidar
