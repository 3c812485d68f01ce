// SPDX-License-Identifier: MIT
// The driver with the simulated device, in virtual time.
#include "g4lidar/lidar.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "support/virtual_transport.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::open_virtual;
using test::virtual_bench;

constexpr std::int64_t ms = 1'000'000;

TEST(Lidar, OpensAHealthyDeviceQuickly) {
  virtual_bench bench;
  const std::int64_t before = bench.now_ns;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar) << lidar.error().message();
  EXPECT_EQ(lidar->information().serial_number(), "2021101000070073");
  EXPECT_LT(bench.now_ns - before, 110 * ms);  // 30 of them listening
  EXPECT_FALSE(lidar->is_scanning());
}

TEST(Lidar, GivesWholeScans) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar) << lidar.error().message();
  const auto started = lidar->start();
  ASSERT_TRUE(started) << started.error().message();
  EXPECT_TRUE(lidar->is_scanning());
  for (int i = 0; i < 100; ++i) {
    const auto scan = lidar->try_scan(2000ms);
    ASSERT_TRUE(scan) << scan.error().message() << " after " << i;
    EXPECT_TRUE(scan->is_whole());
    EXPECT_GT(scan->points.size(), 1000U);
  }
  const auto counts = lidar->counts();
  EXPECT_EQ(counts.scans, 100U);
  EXPECT_EQ(counts.bytes, counts.stream.parsed_bytes + counts.stream.skipped_bytes() + counts.held);
  EXPECT_TRUE(lidar->stop());
  EXPECT_TRUE(bench.device.is_idle_and_silent(bench.now_ns));
}

TEST(Lidar, Destructor_StopsTheMotor) {
  virtual_bench bench;
  {
    auto lidar = open_virtual(bench);
    ASSERT_TRUE(lidar);
    ASSERT_TRUE(lidar->start());
    ASSERT_TRUE(lidar->try_scan(2000ms));
  }
  EXPECT_TRUE(bench.device.is_idle_and_silent(bench.now_ns));
}

TEST(Lidar, ReleasedDuringAScan_ContinuesScanning) {
  virtual_bench bench;
  {
    auto lidar = open_virtual(bench);
    ASSERT_TRUE(lidar);
    ASSERT_TRUE(lidar->start());
    ASSERT_TRUE(lidar->try_scan(2000ms));
    lidar->release();
    EXPECT_FALSE(lidar->is_scanning());
    EXPECT_EQ(lidar->try_scan(0ms).error().code(), problem::gone);
    EXPECT_EQ(lidar->start().error().code(), problem::gone);
    lidar->release();  // nothing is left to release
  }
  bench.now_ns += 5000 * ms;
  EXPECT_FALSE(bench.device.is_idle_and_silent(bench.now_ns));
  auto again = open_virtual(bench);
  ASSERT_TRUE(again) << again.error().message();
  EXPECT_EQ(again->next_event()->what, lidar_event::kind::found_scanning);
  EXPECT_TRUE(bench.device.is_idle_and_silent(bench.now_ns));
}

TEST(Lidar, ReleasedWhenIdle_StaysIdle) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  lidar->release();
  EXPECT_EQ(lidar->ask(requests::health()).error().code(), problem::gone);
  EXPECT_TRUE(bench.device.is_idle_and_silent(bench.now_ns));
}

TEST(Lidar, AppliesTheSettingsOfTheOptions) {
  virtual_bench bench;
  lidar_options options;
  options.sample_rate = sample_rate::khz_4;
  options.frequency = scan_frequency{1000};
  options.direction = motor_direction::counter_clockwise;
  options.protection = power_down_protection::on;
  auto lidar = open_virtual(bench, options);
  ASSERT_TRUE(lidar);
  const auto started = lidar->start();
  ASSERT_TRUE(started) << started.error().message();
  const auto& settings = bench.device.settings();
  EXPECT_EQ(settings.sample_rate, sample_rate::khz_4);
  EXPECT_EQ(settings.scan_frequency_chz, 1000);
  EXPECT_EQ(settings.direction, motor_direction::counter_clockwise);
  EXPECT_EQ(settings.protection, power_down_protection::on);
  for (int i = 0; i < 100; ++i)
    ASSERT_TRUE(lidar->try_scan(2000ms)) << i;  // 10 s: it gets keep-alives
}

TEST(Lidar, RefusesToDisturbAScan) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  ASSERT_TRUE(lidar->try_scan(2000ms));
  const auto refused = lidar->ask(requests::device_info());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code(), problem::scanning);
  EXPECT_FALSE(refused.error().is_fatal());
  const auto health = lidar->ask(requests::health(), while_scanning::stop_and_resume);
  ASSERT_TRUE(health) << health.error().message();
  EXPECT_EQ(health->status, health_status::ok);
  EXPECT_TRUE(lidar->try_scan(2000ms));
}

TEST(Lidar, UnplugWithoutReconnecting_IsFatal) {
  const sim::fault faults[] = {sim::make_fault(sim::fault_kind::unplug, 4000 * ms, 2000 * ms)};
  virtual_bench bench({}, faults);
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  result<scan> scan = failure(task::reading, problem::timeout);
  do {
    scan = lidar->try_scan(500ms);
  } while (scan || !scan.error().is_fatal());
  EXPECT_EQ(scan.error().code(), problem::gone);
  EXPECT_LT(bench.now_ns, 4100 * ms);
  EXPECT_EQ(lidar->next_event()->what, lidar_event::kind::lost);
}

TEST(Lidar, ReconnectsAfterAnUnplug) {
  const sim::fault faults[] = {sim::make_fault(sim::fault_kind::unplug, 4000 * ms, 2000 * ms)};
  virtual_bench bench({}, faults);
  lidar_options options;
  options.reconnect = true;
  options.frequency = scan_frequency{900};
  auto lidar = open_virtual(bench, options);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  while (bench.now_ns < 10'000 * ms) {
    const auto scan = lidar->try_scan(500ms);
    if (!scan) {
      ASSERT_FALSE(scan.error().is_fatal()) << scan.error().message();
    }
  }
  EXPECT_EQ(bench.device.settings().scan_frequency_chz, 900);
  std::vector<lidar_event> events;
  while (const auto event = lidar->next_event()) events.push_back(*event);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].what, lidar_event::kind::lost);
  EXPECT_EQ(events[0].reason, problem::gone);
  EXPECT_EQ(events[1].what, lidar_event::kind::reconnected);
  EXPECT_LT(events[1].time_ns, 8'000 * ms);
  EXPECT_EQ(lidar->counts().reconnects, 1U);
}

}  // namespace
}  // namespace g4lidar
