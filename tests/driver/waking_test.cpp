// SPDX-License-Identifier: MIT
// Who is woken has still got on: what a call had begun goes on in the calls that follow, also where
// each of them is woken, and whichever they are.
#include <gtest/gtest.h>

#include <chrono>
#include <vector>

#include "support/virtual_line.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::open_virtual;
using test::virtual_bench;

constexpr std::int64_t ms = 1'000'000;

/// Calls `work`, woken each time, every millisecond until it gives true: how many calls that took.
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

TEST(Waking, EachCallWokenStillReadsOn) {
  virtual_bench bench;
  auto device = open_virtual(bench);
  ASSERT_TRUE(device);
  calls_until(bench, *device, [&] { return device->start().has_value(); });
  EXPECT_EQ(device->counts().command_retries, 0U);
  for (int i = 0; i < 5; ++i) {
    // A revolution takes 143 ms, the first one and the motor's start a second more.
    const int calls =
        calls_until(bench, *device, [&] { return device->next_scan(1000ms).has_value(); });
    EXPECT_LT(calls, 1500) << i;
  }
  EXPECT_EQ(device->counts().samples_lost, 0U);
  EXPECT_EQ(device->counts().scans_missed, 0U);
  calls_until(bench, *device, [&] { return device->stop().has_value(); });
  EXPECT_TRUE(bench.device.is_idle_and_silent(bench.now_ns));
}

TEST(Waking, EachCallWokenStillGetsItsAnswer) {
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
    // The wake behind which the answer came is for the next call; it is not asked twice.
    EXPECT_EQ(device->ask(requests::health(), how).error().what(), problem::cancelled);
    EXPECT_TRUE(device->ask(requests::health(), how));
    EXPECT_EQ(bench.device.settings().scan_frequency_chz, scanning ? 740 : 720);
  }
  EXPECT_EQ(device->counts().command_retries, 0U);
}

// What another call has come to know meanwhile may be out of date.
TEST(Waking, AnAskThatWasWokenIsAskedAnewBehindOtherCalls) {
  virtual_bench bench;
  auto device = open_virtual(bench);
  ASSERT_TRUE(device);
  device->wake();
  EXPECT_EQ(device->ask(requests::get_scan_frequency()).error().what(), problem::cancelled);
  ASSERT_TRUE(device->ask(requests::set(scan_frequency{1000})));
  const auto frequency = device->ask_for<scan_frequency>(requests::get_scan_frequency());
  ASSERT_TRUE(frequency);
  EXPECT_EQ(frequency->chz, 1000);
}

// Whenever the wake comes, be it with the last answer that the start has waited for.
TEST(Waking, AStartThatWasWokenGoesOnInNextScan) {
  virtual_bench bench;
  auto device = open_virtual(bench);
  ASSERT_TRUE(device);
  calls_until(bench, *device, [&] {
    EXPECT_EQ(device->start().error().what(), problem::cancelled);
    return device->is_scanning();
  });
  EXPECT_TRUE(device->next_scan(5000ms));
}

TEST(Waking, AStartThatWasWokenGoesOnInEveryCall) {
  virtual_bench bench;
  auto device = open_virtual(bench);
  ASSERT_TRUE(device);
  device->wake();
  EXPECT_EQ(device->start().error().what(), problem::cancelled);
  EXPECT_FALSE(device->is_scanning());
  EXPECT_TRUE(device->next_scan(5000ms));
  EXPECT_TRUE(device->is_scanning());
  EXPECT_TRUE(device->start());
}

TEST(Waking, WhatAStartThatWasWokenHasComeToIsTold) {
  sim::device_options options;
  options.condition = {health_status::error, 0x0102};
  virtual_bench bench(options);
  auto device = open_virtual(bench);
  ASSERT_TRUE(device);
  device->wake();
  EXPECT_EQ(device->start().error().what(), problem::cancelled);
  EXPECT_EQ(device->next_scan(5000ms).error().what(), problem::unhealthy);
  EXPECT_EQ(device->next_scan(10ms).error().what(), problem::not_scanning);
  EXPECT_FALSE(device->is_scanning());
  EXPECT_EQ(device->start().error().what(), problem::unhealthy);
}

TEST(Waking, AStartThatWasWokenIsMadeUpForBehindAnUnplug) {
  lidar_options options;
  options.reconnect = true;
  virtual_bench bench;
  auto device = open_virtual(bench, options);
  ASSERT_TRUE(device);
  device->wake();
  EXPECT_EQ(device->start().error().what(), problem::cancelled);
  bench.device.unplug(bench.now_ns);
  EXPECT_EQ(device->next_scan(200ms).error().what(), problem::timeout);
  bench.device.replug(bench.now_ns);
  const std::int64_t end_ns = bench.now_ns + 10'000 * ms;
  while (device->counts().reconnects == 0 && bench.now_ns < end_ns) {
    static_cast<void>(device->next_scan(100ms));
  }
  EXPECT_EQ(device->counts().reconnects, 1U);
  EXPECT_TRUE(device->next_scan(5000ms));
}

TEST(Waking, AStopThatWasWokenIsNoScan) {
  virtual_bench bench;
  auto device = open_virtual(bench);
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->start());
  ASSERT_TRUE(device->next_scan(5000ms));
  device->wake();
  EXPECT_EQ(device->stop().error().what(), problem::cancelled);
  EXPECT_FALSE(device->is_scanning());
  EXPECT_EQ(device->next_scan(10ms).error().what(), problem::not_scanning);
  EXPECT_TRUE(device->stop());
  EXPECT_TRUE(bench.device.is_idle_and_silent(bench.now_ns));
}

}  // namespace
}  // namespace g4lidar
