// SPDX-License-Identifier: MIT
// What an event loop needs in C: the deadline, processing without waiting, stopping.
#include <poll.h>

#include <cstdint>
#include <limits>

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
  for (int waits = 0; code == G4LIDAR_TIMEOUT && waits < 10'000; ++waits) {
    const std::int64_t deadline = g4lidar_deadline_ns(it.get());
    ASSERT_NE(deadline, never);
    // Between the two readings of the clock, rounded up; 0 where the deadline has passed.
    const auto rounded_up_ms = [&](std::int64_t now) {
      return deadline <= now ? 0 : (deadline - now + 999'999) / 1'000'000;
    };
    const std::int64_t before = g4lidar_now_ns();
    const int timeout_ms = g4lidar_poll_timeout_ms(it.get());
    EXPECT_LE(timeout_ms, rounded_up_ms(before));
    EXPECT_GE(timeout_ms, rounded_up_ms(g4lidar_now_ns()));
    pollfd waiting{g4lidar_descriptor(it.get()), POLLIN, 0};
    ASSERT_GE(::poll(&waiting, 1, timeout_ms), 0);
    do {
      code = g4lidar_next_scan(it.get(), 0, &scan, &why);
    } while (code == G4LIDAR_OK);
  }
  EXPECT_EQ(code, G4LIDAR_STALLED) << why.message;
}

TEST(CLoop, AClosedLidarHasNoDeadline) {
  const simulator device = simulate();
  const lidar it = start_on(device);
  EXPECT_EQ(g4lidar_descriptor(it.get()), -1);  // virtual time
  EXPECT_NE(g4lidar_deadline_ns(it.get()), never);
  ASSERT_EQ(g4lidar_close(it.get(), nullptr), G4LIDAR_OK);
  EXPECT_EQ(g4lidar_deadline_ns(it.get()), never);
  EXPECT_EQ(g4lidar_poll_timeout_ms(it.get()), -1);
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
  while (g4lidar_next_scan(it.get(), 0, &scan, &why) == G4LIDAR_OK) continue;
  EXPECT_EQ(why.code, G4LIDAR_NOT_SCANNING) << why.message;
  ASSERT_EQ(g4lidar_start(it.get(), nullptr), G4LIDAR_OK);
  EXPECT_NE(next_whole(it), nullptr);
}

}  // namespace
