// SPDX-License-Identifier: MIT
// What an event loop needs in C: the deadline, processing without waiting, stopping.
#include <poll.h>

#include <cstdint>
#include <limits>
#include <string>

#include "c_handles.hpp"

namespace {

using namespace g4lidar_c_test;

constexpr std::int64_t second = 1'000'000'000;
constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();

lidar open_source(const char* device, std::int32_t stall_time_ms = 0) {
  g4lidar_options options = defaults();
  options.device = device;
  options.stall_time_ms = stall_time_ms;
  g4lidar_lidar* made = nullptr;
  g4lidar_error why;
  EXPECT_EQ(g4lidar_open_with(&options, &made, &why), G4LIDAR_OK) << why.message;
  return lidar(made);
}

TEST(CLoop, DeadlineEndsTheWaitForASilentLidar) {
  const lidar it = open_source("sim:?fault=stall@1s&serial=2021101000070333", 300);
  EXPECT_STREQ(g4lidar_get_identity(it.get())->serial_number, "2021101000070333");
  g4lidar_error why;
  ASSERT_EQ(g4lidar_start(it.get(), &why), G4LIDAR_OK) << why.message;
  const g4lidar_scan* scan = nullptr;
  int code = G4LIDAR_TIMEOUT;
  int compared = 0;
  for (int waits = 0; code == G4LIDAR_TIMEOUT && waits < 10'000; ++waits) {
    const std::int64_t deadline = g4lidar_deadline_ns(it.get());
    ASSERT_NE(deadline, never);
    // Between the two readings of the clock, rounded up; 0 where the deadline has passed.
    const auto rounded_up_ms = [&](std::int64_t now) {
      return deadline <= now ? 0 : (deadline - now + 999'999) / 1'000'000;
    };
    const std::int64_t before = g4lidar_now_ns();
    const int timeout_ms = g4lidar_poll_timeout_ms(it.get());
    const std::int64_t after = g4lidar_now_ns();
    if (g4lidar_deadline_ns(it.get()) == deadline) {  // it changes when bytes arrive
      EXPECT_LE(timeout_ms, rounded_up_ms(before));
      EXPECT_GE(timeout_ms, rounded_up_ms(after));
      ++compared;
    }
    pollfd waiting{g4lidar_descriptor(it.get()), POLLIN, 0};
    ASSERT_GE(::poll(&waiting, 1, timeout_ms), 0);
    do {
      code = g4lidar_try_scan(it.get(), 0, &scan, &why);
    } while (code == G4LIDAR_OK);
  }
  EXPECT_EQ(code, G4LIDAR_STALLED) << why.message;
  EXPECT_GT(compared, 0);
}

/// The scans of a loop, until it ends or this many have come.
int loop(const lidar& over, int timeout_ms, int most, g4lidar_error& why) {
  const g4lidar_scan* scan = nullptr;
  int count = 0;
  while (count < most && g4lidar_wait_scan(over.get(), timeout_ms, &scan, &why) == G4LIDAR_OK) {
    ++count;
  }
  return count;
}

TEST(CLoop, AWaitForAScanDoesNotEndForASpinUp) {
  g4lidar_error why;
  for (const char* setup : {"sim:?seed=1", "sim:?seed=2", "sim:?seed=3", "sim:?seed=4",
                            "sim:?seed=5", "sim:?seed=6", "sim:?silence_ns=8s"}) {
    const simulator device = simulate(setup);
    const lidar it = start_on(device);
    EXPECT_EQ(loop(it, 300, 10, why), 10) << setup << ": " << why.message;
  }
  const simulator device = simulate("sim:?silence_ns=60s");
  const lidar it = start_on(device);
  const std::int64_t begin_ns = g4lidar_simulator_get_state(device.get())->time_ns;
  EXPECT_EQ(loop(it, 300, 1, why), 0);
  EXPECT_EQ(why.code, G4LIDAR_TIMEOUT);
  EXPECT_NE(std::string(why.message).find("the motor spins up"), std::string::npos) << why.message;
  const std::int64_t passed_ns = g4lidar_simulator_get_state(device.get())->time_ns - begin_ns;
  EXPECT_GT(passed_ns, 9 * second);
  EXPECT_LT(passed_ns, 11 * second);
}

TEST(CLoop, AWaitForAScanDoesNotEndForAnUnplugWithReconnecting) {
  g4lidar_options options = defaults();
  g4lidar_error why;
  for (const bool reconnects : {true, false}) {
    options.reconnect = reconnects;
    const simulator device = simulate("sim:?fault=unplug@4s%2B60s");
    const lidar it = start_on(device, &options);
    const int scans = loop(it, 300, 100, why);
    if (reconnects) {
      EXPECT_EQ(scans, 100) << why.message;
      EXPECT_EQ(g4lidar_get_counts(it.get())->reconnects, 1U);
    } else {
      EXPECT_LT(scans, 100);
      EXPECT_EQ(why.code, G4LIDAR_GONE) << why.message;
    }
  }
}

TEST(CLoop, AWaitForAScanEndsWhereOneThatIsDueDoesNotCome) {
  const simulator device = simulate("sim:?fault=stall@4s");
  const lidar it = start_on(device);
  g4lidar_error why;
  EXPECT_GT(loop(it, 300, 100, why), 10);
  EXPECT_EQ(why.code, G4LIDAR_TIMEOUT) << why.message;
  EXPECT_LT(g4lidar_simulator_get_state(device.get())->time_ns, 5 * second);
}

TEST(CLoop, AWakeEndsTheWaitForAScan) {
  const simulator device = simulate("sim:?silence_ns=5s");
  const lidar it = start_on(device);
  g4lidar_error why;
  g4lidar_wake(it.get());
  EXPECT_EQ(loop(it, 300, 1, why), 0);
  EXPECT_EQ(why.code, G4LIDAR_CANCELLED) << why.message;
  EXPECT_EQ(loop(it, 300, 3, why), 3);
}

TEST(CLoop, ProcessingCountsTheScansThatNobodyTakes) {
  const simulator device = simulate("sim:?seed=5");
  const lidar it = start_on(device);
  for (int i = 0; i < 50; ++i) {
    ASSERT_EQ(g4lidar_simulator_advance(device.get(), second / 10), G4LIDAR_OK);
    ASSERT_EQ(g4lidar_process(it.get(), nullptr), G4LIDAR_OK);
  }
  // 5 s at 7 Hz, of which the motor needs some to reach its speed.
  const g4lidar_counts counts = *g4lidar_get_counts(it.get());
  EXPECT_GE(counts.scans, 20U);
  EXPECT_LE(counts.scans, 35U);
  EXPECT_EQ(counts.scans_missed, counts.scans);
}

TEST(CLoop, AStoppedScanEndsAndBeginsAgain) {
  const simulator device = simulate();
  const lidar it = start_on(device);
  ASSERT_NE(next_whole(it), nullptr);
  ASSERT_EQ(g4lidar_stop(it.get(), nullptr), G4LIDAR_OK);
  EXPECT_FALSE(g4lidar_is_scanning(it.get()));
  EXPECT_FALSE(g4lidar_simulator_get_state(device.get())->is_scanning);
  const g4lidar_scan* scan = nullptr;
  g4lidar_error why;
  while (g4lidar_try_scan(it.get(), 0, &scan, &why) == G4LIDAR_OK) continue;
  EXPECT_EQ(why.code, G4LIDAR_NOT_SCANNING) << why.message;
  ASSERT_EQ(g4lidar_start(it.get(), nullptr), G4LIDAR_OK);
  EXPECT_NE(next_whole(it), nullptr);
}

}  // namespace
