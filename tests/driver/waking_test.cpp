// SPDX-License-Identifier: MIT
// A woken call makes progress: the next calls continue what it had begun, also if each of them is
// woken, and for every kind of call.
#include <gtest/gtest.h>

#include <chrono>
#include <vector>

#include "support/virtual_transport.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::open_virtual;
using test::virtual_bench;

constexpr std::int64_t ms = 1'000'000;

/// Calls `work`, woken each time, every millisecond until it returns true; returns the number of
/// calls.
template <class Work>
int calls_until(virtual_bench& bench, lidar& device, Work&& work) {
  for (int calls = 1; calls <= 5000; ++calls) {
    bench.now_ns += 1 * ms;
    device.wake();
    if (work()) return calls;
  }
  ADD_FAILURE() << "it never comes to its end";
  return 5000;
}

TEST(Waking, EveryCallWoken_StillReads) {
  virtual_bench bench;
  auto device = open_virtual(bench);
  ASSERT_TRUE(device);
  calls_until(bench, *device, [&] { return device->start().has_value(); });
  EXPECT_EQ(device->counts().command_retries, 0U);
  for (int i = 0; i < 5; ++i) {
    // A revolution takes 143 ms, the first one and the start of the motor a second more.
    const int calls =
        calls_until(bench, *device, [&] { return device->try_scan(1000ms).has_value(); });
    EXPECT_LT(calls, 1500) << i;
  }
  EXPECT_EQ(device->counts().samples_lost, 0U);
  EXPECT_EQ(device->counts().scans_missed, 0U);
  calls_until(bench, *device, [&] { return device->stop().has_value(); });
  EXPECT_TRUE(bench.device.is_idle_and_silent(bench.now_ns));
}

TEST(Waking, EveryCallWoken_StillGetsItsAnswer) {
  virtual_bench bench;
  auto device = open_virtual(bench);
  ASSERT_TRUE(device);
  for (const bool scanning : {false, true}) {
    if (scanning) {
      ASSERT_TRUE(device->start());
    }
    const auto how = while_scanning::stop_and_resume;
    for (const auto step : {frequency_step::up_0_1_hz, frequency_step::up_0_1_hz}) {
      calls_until(bench, *device,
                  [&] { return device->ask(requests::step(step), how).has_value(); });
    }
    // The wake after which the answer arrived is for the next call; the query is not repeated.
    EXPECT_EQ(device->ask(requests::health(), how).error().code(), problem::cancelled);
    EXPECT_TRUE(device->ask(requests::health(), how));
    EXPECT_EQ(bench.device.settings().scan_frequency_chz, scanning ? 740 : 720);
  }
  EXPECT_EQ(device->counts().command_retries, 0U);
}

// The result that another call has received may be obsolete.
TEST(Waking, WokenAsk_IsRepeatedAfterOtherCalls) {
  virtual_bench bench;
  auto device = open_virtual(bench);
  ASSERT_TRUE(device);
  device->wake();
  EXPECT_EQ(device->ask(requests::get_scan_frequency()).error().code(), problem::cancelled);
  ASSERT_TRUE(device->ask(requests::set(scan_frequency{1000})));
  const auto frequency = device->ask(requests::get_scan_frequency());
  ASSERT_TRUE(frequency);
  EXPECT_EQ(frequency->chz, 1000);
}

// For every time of the wake, also together with the last answer that the start waits for.
TEST(Waking, WokenStart_ContinuesInTryScan) {
  virtual_bench bench;
  auto device = open_virtual(bench);
  ASSERT_TRUE(device);
  calls_until(bench, *device, [&] {
    EXPECT_EQ(device->start().error().code(), problem::cancelled);
    return device->is_scanning();
  });
  EXPECT_TRUE(device->try_scan(5000ms));
}

TEST(Waking, WokenStart_ContinuesInEveryCall) {
  virtual_bench bench;
  auto device = open_virtual(bench);
  ASSERT_TRUE(device);
  device->wake();
  EXPECT_EQ(device->start().error().code(), problem::cancelled);
  EXPECT_FALSE(device->is_scanning());
  EXPECT_TRUE(device->try_scan(5000ms));
  EXPECT_TRUE(device->is_scanning());
  EXPECT_TRUE(device->start());
}

TEST(Waking, WokenStart_ReportsItsResult) {
  sim::device_options options;
  options.condition = {health_status::error, 0x0102};
  virtual_bench bench(options);
  auto device = open_virtual(bench);
  ASSERT_TRUE(device);
  device->wake();
  EXPECT_EQ(device->start().error().code(), problem::cancelled);
  EXPECT_EQ(device->try_scan(5000ms).error().code(), problem::unhealthy);
  EXPECT_EQ(device->try_scan(10ms).error().code(), problem::not_scanning);
  EXPECT_FALSE(device->is_scanning());
  EXPECT_EQ(device->start().error().code(), problem::unhealthy);
}

TEST(Waking, WokenStart_IsRepeatedAfterAnUnplug) {
  lidar_options options;
  options.reconnect = true;
  virtual_bench bench;
  auto device = open_virtual(bench, options);
  ASSERT_TRUE(device);
  device->wake();
  EXPECT_EQ(device->start().error().code(), problem::cancelled);
  bench.device.unplug(bench.now_ns);
  EXPECT_EQ(device->try_scan(200ms).error().code(), problem::reconnecting);
  EXPECT_EQ(device->try_scan(200ms).error().code(), problem::timeout);
  bench.device.replug(bench.now_ns);
  const std::int64_t end_ns = bench.now_ns + 10'000 * ms;
  while (device->counts().reconnects == 0 && bench.now_ns < end_ns) {
    static_cast<void>(device->try_scan(100ms));
  }
  EXPECT_EQ(device->counts().reconnects, 1U);
  EXPECT_TRUE(device->try_scan(5000ms));
}

TEST(Waking, WokenStop_IsNotScanning) {
  virtual_bench bench;
  auto device = open_virtual(bench);
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->start());
  ASSERT_TRUE(device->try_scan(5000ms));
  device->wake();
  EXPECT_EQ(device->stop().error().code(), problem::cancelled);
  EXPECT_FALSE(device->is_scanning());
  EXPECT_EQ(device->try_scan(10ms).error().code(), problem::not_scanning);
  EXPECT_TRUE(device->stop());
  EXPECT_TRUE(bench.device.is_idle_and_silent(bench.now_ns));
}

}  // namespace
}  // namespace g4lidar
