// SPDX-License-Identifier: MIT
// A device that reboots without a loss of the link loses its settings: the driver applies them again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <span>

#include "g4lidar/lidar.hpp"
#include "support/virtual_transport.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::open_virtual;
using test::virtual_bench;

constexpr std::int64_t ms = 1'000'000;

/// Loses its settings with its power, and measures at 9 kHz then.
sim::device_options forgetful() {
  sim::device_options options;
  options.settings_outlive_power = false;
  options.boot_ns = 100 * ms;
  options.header_ns = 200 * ms;
  return options;
}

/// The voltage breaks down so long after the motor has started, while the fault lasts.
sim::fault dip(std::int64_t after_motor_ns, std::int64_t begin_ns, std::int64_t duration_ns) {
  sim::fault fault = sim::make_fault(sim::fault_kind::reboot, begin_ns, duration_ns);
  fault.amount = after_motor_ns;
  return fault;
}

lidar_options at_4_khz() {
  lidar_options options;
  options.sample_rate = sample_rate::khz_4;
  options.frequency = scan_frequency{1000};
  return options;
}

void expect_settings_and_times(virtual_bench& bench, lidar& device) {
  ASSERT_TRUE(device.is_scanning());
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(device.try_scan(2000ms)) << i;
  EXPECT_EQ(bench.device.settings().sample_rate, sample_rate::khz_4);
  EXPECT_EQ(bench.device.settings().scan_frequency_chz, 1000);
  const auto scan = device.try_scan(2000ms);
  ASSERT_TRUE(scan);
  const auto took_ns = scan->points.back().time_ns - scan->points.front().time_ns;
  EXPECT_NEAR(static_cast<double>(took_ns) / static_cast<double>(scan->points.size() - 1), 250e3,
              2.5e3);
}

TEST(UnnoticedReboot, BeforeTheScanHeader) {
  const sim::fault faults[] = {dip(50 * ms, 0, 2500 * ms)};
  virtual_bench bench(forgetful(), faults);
  auto device = open_virtual(bench, at_4_khz());
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->start());
  expect_settings_and_times(bench, *device);
}

/// The motor turns as soon as low power is off.
TEST(UnnoticedReboot, DuringTheSettings) {
  const sim::fault faults[] = {dip(0, 0, 1200 * ms)};
  virtual_bench bench(forgetful(), faults);
  lidar_options options = at_4_khz();
  options.idle = low_power::off;
  auto device = open_virtual(bench, options);
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->start());
  expect_settings_and_times(bench, *device);
  EXPECT_EQ(bench.device.settings().idle_power, low_power::off);
}

TEST(UnnoticedReboot, WhenTheScanIsResumed) {
  const sim::fault faults[] = {dip(50 * ms, 4000 * ms, 1500 * ms)};
  virtual_bench bench(forgetful(), faults);
  auto device = open_virtual(bench, at_4_khz());
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->start());
  while (bench.now_ns < 4100 * ms) static_cast<void>(device->try_scan(500ms));
  EXPECT_TRUE(device->ask(requests::health(), while_scanning::stop_and_resume));
  expect_settings_and_times(bench, *device);
}

TEST(UnnoticedReboot, UnderKeepAlives) {
  sim::device_options quick = forgetful();
  quick.header_ns = 0;
  const sim::fault faults[] = {dip(2300 * ms, 0, 4000 * ms)};
  virtual_bench bench(quick, faults);
  lidar_options options = at_4_khz();
  options.protection = power_down_protection::on;
  auto device = open_virtual(bench, options);
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->start());
  while (bench.now_ns < 5000 * ms) static_cast<void>(device->try_scan(500ms));
  const auto event = device->next_event();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->what, lidar_event::kind::restarted);
  expect_settings_and_times(bench, *device);
}

/// How often the device received this command.
int times_in(const sim::device& device, std::uint8_t code) {
  return static_cast<int>(std::ranges::count(device.log(), code, &sim::asked::code));
}

/// The scan ended by itself while the program was busy, and the call that notices it is the stop: the device
/// is not set up and started once more.
TEST(UnnoticedReboot, StopThatNoticesIt_SetsNothingUp) {
  sim::device_options protects = forgetful();
  protects.initial.protection = power_down_protection::on;
  for (const bool is_protected : {false, true}) {
    SCOPED_TRACE(is_protected);
    const sim::fault faults[] = {dip(2300 * ms, 0, 60'000 * ms)};
    virtual_bench bench(is_protected ? protects : forgetful(),
                        std::span(faults).first(is_protected ? 0 : 1));
    auto device = open_virtual(bench, at_4_khz());
    ASSERT_TRUE(device);
    ASSERT_TRUE(device->start());
    ASSERT_TRUE(device->try_scan(2000ms));
    while (device->try_scan(400ms)) {
    }
    ASSERT_TRUE(device->is_scanning());
    ASSERT_FALSE(device->next_event());
    bench.now_ns += 1000 * ms;  // longer than stall_time
    bench.device.clear_log();
    EXPECT_TRUE(device->stop());
    const auto event = device->next_event();
    ASSERT_TRUE(event) << "the stop has not noticed it";
    EXPECT_EQ(event->what,
              is_protected ? lidar_event::kind::protection_found_on : lidar_event::kind::restarted);
    EXPECT_FALSE(device->is_scanning());
    EXPECT_TRUE(bench.device.is_idle_and_silent(bench.now_ns));
    EXPECT_EQ(times_in(bench.device, 0x60), 0);
    EXPECT_EQ(device->try_scan(500ms).error(), problem::not_scanning);
  }
}

/// The same for a restart by the caller whose call was woken: only the request itself starts again.
TEST(UnnoticedReboot, StopAfterAWokenRestart_SetsNothingUp) {
  virtual_bench bench(forgetful());
  auto device = open_virtual(bench, at_4_khz());
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->start());
  ASSERT_TRUE(device->try_scan(5000ms));
  bench.device.clear_log();
  device->wake();
  const auto woken = device->ask(requests::restart(), while_scanning::stop_and_resume);
  EXPECT_EQ(woken.error(), problem::cancelled);
  EXPECT_TRUE(device->stop());
  EXPECT_TRUE(bench.device.is_idle_and_silent(bench.now_ns));
  EXPECT_EQ(times_in(bench.device, 0x60), 1);
}

/// What a healthy device is sent has not become more, also if it refuses to go beyond 12 Hz.
TEST(UnnoticedReboot, AQuickStartSendsNothingMore) {
  for (const sim::at_limit limit : {sim::at_limit::clamp, sim::at_limit::refuse}) {
    sim::device_options options;
    options.frequency_at_limit = limit;
    options.scanner.scan_frequency_chz = 1150;
    virtual_bench bench(options);
    lidar_options wanted;
    wanted.frequency = scan_frequency{1200};
    auto device = open_virtual(bench, wanted);
    ASSERT_TRUE(device);
    bench.device.clear_log();
    ASSERT_TRUE(device->start());
    EXPECT_EQ(times_in(bench.device, 0x91), 1);
    EXPECT_EQ(times_in(bench.device, 0x60), 1);
  }
}

}  // namespace
}  // namespace g4lidar
