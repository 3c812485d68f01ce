// SPDX-License-Identifier: MIT
// Faults that the seeded runs of tests/simulation have found, each as short as possible.
#include <gtest/gtest.h>

#include "g4lidar/lidar.hpp"
#include "support/virtual_transport.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::open_virtual;
using test::virtual_bench;

constexpr std::int64_t ms = 1'000'000;

TEST(FoundBySimulation, StartsAsOftenAsItIsStopped) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(lidar->start());
    ASSERT_TRUE(bench.device.is_scanning()) << i;
    ASSERT_TRUE(lidar->try_scan(2000ms)) << i;
    ASSERT_TRUE(lidar->stop());
    ASSERT_FALSE(bench.device.is_scanning()) << i;
  }
}

TEST(FoundBySimulation, BytesReceivedWhileSuspended_AreNoSilence) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  ASSERT_TRUE(lidar->try_scan(2000ms));
  bench.now_ns += 2000 * ms;  // longer than a scan may be silent
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(lidar->try_scan(500ms)) << i;
  EXPECT_FALSE(lidar->next_event());
  EXPECT_EQ(lidar->counts().samples_lost, 0U);
}

TEST(FoundBySimulation, RepeatedStart_FindsTheDeviceAgain) {
  const sim::fault faults[] = {sim::make_fault(sim::fault_kind::unplug, 2000 * ms, 1000 * ms)};
  virtual_bench bench({}, faults);
  lidar_options options;
  options.reconnect = true;
  auto lidar = open_virtual(bench, options);
  ASSERT_TRUE(lidar);
  bench.now_ns = 2500 * ms;
  EXPECT_FALSE(lidar->start());
  while (bench.now_ns < 6000 * ms && !lidar->start()) bench.now_ns += 100 * ms;
  EXPECT_TRUE(lidar->is_scanning());
  EXPECT_TRUE(lidar->try_scan(2000ms));
}

TEST(FoundBySimulation, WokenAsk_InterruptsTheScanLikeAnyOther) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(lidar->try_scan(2000ms));
  lidar->wake();
  const auto woken = lidar->ask(requests::health(), while_scanning::stop_and_resume);
  ASSERT_FALSE(woken);
  EXPECT_EQ(woken.error().code(), problem::cancelled);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(lidar->try_scan(2000ms)) << i;
  EXPECT_EQ(lidar->counts().samples_lost, 0U);
}

TEST(FoundBySimulation, WokenStop_ThenStarts) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  ASSERT_TRUE(lidar->try_scan(2000ms));
  lidar->wake();
  EXPECT_FALSE(lidar->stop());
  ASSERT_TRUE(lidar->start());
  EXPECT_TRUE(lidar->try_scan(2000ms));
  EXPECT_TRUE(bench.device.is_scanning());
}

TEST(FoundBySimulation, WakeAfterASuspension_IsNoSilence) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(lidar->try_scan(2000ms));
    bench.now_ns += 1500 * ms;
    lidar->wake();
    static_cast<void>(lidar->try_scan(100ms));
  }
  EXPECT_FALSE(lidar->next_event());
}

/// A device that loses its settings by a reboot, which happens during a scan.
sim::device_options forgetful() {
  sim::device_options options;
  options.settings_outlive_restart = false;
  options.settings_outlive_power = false;
  return options;
}

TEST(FoundBySimulation, SettingsLostByAReboot_AreSetAgain) {
  const sim::fault faults[] = {sim::make_fault(sim::fault_kind::reboot, 0, 1500 * ms)};
  virtual_bench bench(forgetful(), faults);
  lidar_options options;
  options.sample_rate = sample_rate::khz_4;
  auto lidar = open_virtual(bench, options);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  for (int i = 0; i < 20; ++i) static_cast<void>(lidar->try_scan(500ms));
  const auto event = lidar->next_event();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->what, lidar_event::kind::restarted);
  ASSERT_TRUE(lidar->is_scanning());
  EXPECT_EQ(*lidar->ask(requests::get_sample_rate(), while_scanning::stop_and_resume),
            sample_rate::khz_4);
}

TEST(FoundBySimulation, SettingsOfAsk_AreSetAgainAfterARestart) {
  virtual_bench bench(forgetful());
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->ask(requests::set(scan_frequency{1100})));
  ASSERT_TRUE(lidar->start());
  ASSERT_TRUE(lidar->try_scan(2000ms));
  ASSERT_TRUE(lidar->ask(requests::restart(), while_scanning::stop_and_resume));
  EXPECT_TRUE(lidar->try_scan(2000ms));
  const auto frequency =
      lidar->ask(requests::get_scan_frequency(), while_scanning::stop_and_resume);
  EXPECT_EQ(*frequency, scan_frequency{1100});
}

TEST(FoundBySimulation, SettingsOfAsk_AreSetAgainAfterManyRestarts) {
  virtual_bench bench(forgetful());
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->ask(requests::set(sample_rate::khz_4)));
  ASSERT_TRUE(lidar->start());
  for (int i = 0; i < 6; ++i) {
    ASSERT_TRUE(lidar->ask(requests::restart(), while_scanning::stop_and_resume)) << i;
    EXPECT_EQ(*lidar->ask(requests::get_sample_rate(), while_scanning::stop_and_resume),
              sample_rate::khz_4)
        << i;
  }
}

TEST(FoundBySimulation, SettingsOfAsk_AreSetAgainAfterAWokenRestart) {
  virtual_bench bench(forgetful());
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->ask(requests::set(scan_frequency{1100})));
  ASSERT_TRUE(lidar->start());
  ASSERT_TRUE(lidar->try_scan(2000ms));
  lidar->wake();
  EXPECT_FALSE(lidar->ask(requests::restart(), while_scanning::stop_and_resume));
  EXPECT_TRUE(lidar->try_scan(5000ms));
  const auto frequency =
      lidar->ask(requests::get_scan_frequency(), while_scanning::stop_and_resume);
  EXPECT_EQ(*frequency, scan_frequency{1100});
}

/// Devices with a sample rate above or below the nominal one.
result<lidar> open_with(virtual_bench& bench, std::chrono::milliseconds batch) {
  lidar_options options;
  options.tuning.batch = batch;
  return open_virtual(bench, options);
}

TEST(FoundBySimulation, SuspensionAtTheStart_LosesNothing) {
  for (const double ratio : {0.97, 0.9797, 0.9962, 1.03}) {
    for (std::int64_t slept_ms = 50; slept_ms <= 1500; slept_ms += 145) {
      sim::device_options wrong;
      wrong.scanner.sample_rate_ratio = ratio;
      virtual_bench bench(wrong);
      auto lidar = open_with(bench, slept_ms % 2 == 0 ? 8ms : 0ms);
      ASSERT_TRUE(lidar);
      ASSERT_TRUE(lidar->start());
      static_cast<void>(lidar->try_scan(std::chrono::milliseconds(slept_ms / 50)));
      bench.now_ns += slept_ms * ms;
      for (int i = 0; i < 15; ++i) ASSERT_TRUE(lidar->try_scan(500ms)) << ratio << ", scan " << i;
      EXPECT_EQ(lidar->counts().samples_lost, 0U) << ratio << ", " << slept_ms << " ms";
    }
  }
}

// The host holds 64 KiB back; the number of turns after that is not known.
TEST(FoundBySimulation, BytesLostWhileSuspended_DoNotShiftTheTimes) {
  for (const int chz : {500, 700, 1190}) {
    sim::device_options wrong;
    wrong.scanner.sample_rate_ratio = 1.0271;
    wrong.scanner.scan_frequency_chz = static_cast<std::uint16_t>(chz);
    virtual_bench bench(wrong);
    auto lidar = open_with(bench, 39ms);
    ASSERT_TRUE(lidar);
    ASSERT_TRUE(lidar->start());
    for (int i = 0; i < 12; ++i) {
      bench.now_ns += (3100 + 130 * i) * ms;
      for (int scans = 0; scans < 4; ++scans) static_cast<void>(lidar->try_scan(500ms));
    }
    const std::int64_t end_ns = bench.now_ns + 1500 * ms;
    while (bench.now_ns < end_ns) static_cast<void>(lidar->try_scan(500ms));
    const auto scan = lidar->try_scan(500ms);
    ASSERT_TRUE(scan);
    EXPECT_LT(bench.now_ns - scan->points.back().time_ns, 60 * ms) << chz;
  }
}

TEST(FoundBySimulation, Times_FollowASampleRateSetByAsk) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  ASSERT_TRUE(lidar->try_scan(2000ms));
  ASSERT_TRUE(lidar->ask(requests::set(sample_rate::khz_4), while_scanning::stop_and_resume));
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(lidar->try_scan(2000ms)) << i;
  const auto scan = lidar->try_scan(2000ms);
  ASSERT_TRUE(scan);
  const auto took_ns = scan->points.back().time_ns - scan->points.front().time_ns;
  EXPECT_NEAR(static_cast<double>(took_ns) / static_cast<double>(scan->points.size() - 1), 250e3,
              2.5e3);
}

TEST(FoundBySimulation, SuspensionAtTheBegin_GivesNoFutureTimes) {
  virtual_bench bench;
  auto lidar = open_virtual(bench);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  bench.now_ns += 800 * ms;
  const auto points = lidar->next_points(0ms);
  ASSERT_TRUE(points);
  ASSERT_GT(points->size(), 4000U);
  EXPECT_LT(points->back().time_ns, bench.now_ns + 1 * ms);
}

TEST(FoundBySimulation, QuickSpinUp_LosesNothing) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    sim::device_options options;
    options.scanner.seed = seed;
    options.scanner.scan_frequency_chz = 1150;
    options.acceleration_mhz_per_s = 25'000;
    virtual_bench bench(options);
    auto lidar = open_virtual(bench);
    ASSERT_TRUE(lidar);
    ASSERT_TRUE(lidar->start());
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(lidar->try_scan(2000ms)) << i;
    EXPECT_EQ(lidar->counts().samples_lost, 0U) << seed;
  }
}

}  // namespace
}  // namespace g4lidar
