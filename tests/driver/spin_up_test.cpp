// SPDX-License-Identifier: MIT
// A device that sends nothing while its motor spins up is waited for; a device that never starts is
// given up.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/virtual_port.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
using kind = lidar_event::kind;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t second = 1'000 * ms;

std::int64_t starts_in(const sim::device& simulated) {
  return std::ranges::count(simulated.log(), 0x60, [](const sim::asked& a) { return int{a.code}; });
}

/// The times at which a device was open, and its scan was started.
struct begun {
  std::int64_t opened_ns = 0;
  std::int64_t started_ns = 0;
};
begun begin_on(const sim::device_options& options) {
  sim::device simulated(sim::built_in_world(), options);
  sim::virtual_clock clock;
  begun times;
  auto lidar = lidar::open(std::make_unique<sim::virtual_connector>(simulated, clock));
  EXPECT_TRUE(lidar);
  if (!lidar) return times;
  times.opened_ns = clock.now_ns();
  const auto started = lidar->start();
  EXPECT_TRUE(started);
  times.started_ns = clock.now_ns() - times.opened_ns;
  EXPECT_EQ(starts_in(simulated), 1);
  EXPECT_EQ(lidar->counts().command_retries, 0U);
  return times;
}

// 30 ms of silence before the stop and 50 ms after it, and some milliseconds for each query.
TEST(Patience, QuickDevice_IsNotDelayed) {
  const begun quick = begin_on({});
  EXPECT_LE(quick.opened_ns, 86 * ms);
  EXPECT_LE(quick.started_ns, 24 * ms);
}

TEST(Patience, SlowDevice_IsWaitedForWithinItsLimits) {
  sim::device_options boots;
  boots.boots_at_start = true;
  boots.boot_ns = 10 * ms;
  boots.boot_text = boots.boot_information = false;
  boots.first_answer_ns = 900 * ms;
  EXPECT_LE(begin_on(boots).opened_ns, 990 * ms);
  sim::device_options slow;
  slow.reaction_ns = 250 * ms;
  slow.header_ns = 1700 * ms;  // and the reaction: 1.95 s of the 2 s that a start may take
  EXPECT_LE(begin_on(slow).started_ns, 1700 * ms + 5 * 260 * ms);
}

class spin_up : public testing::TestWithParam<std::int64_t> {};

TEST_P(spin_up, IsWaitedForWithOneStartCommand) {
  sim::device_options device;
  device.silence_ns = GetParam() * ms;
  sim::device simulated(sim::built_in_world(), device);
  sim::virtual_clock clock;
  auto lidar = lidar::open(std::make_unique<sim::virtual_connector>(simulated, clock));
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  const std::int64_t started_ns = clock.now_ns();
  result<scan> first = failure(task::reading, problem::timeout);
  while (!first && clock.now_ns() < started_ns + 20 * second) first = lidar->try_scan(500ms);
  ASSERT_TRUE(first);
  // At 7 Hz the first whole revolution ends at most two turns after the first packet.
  EXPECT_LE(clock.now_ns() - started_ns, std::max(GetParam() * ms, 600 * ms) + 300 * ms);
  EXPECT_EQ(starts_in(simulated), 1);
  std::vector<kind> events;
  while (const auto event = lidar->next_event()) events.push_back(event->what);
  const bool is_reported = GetParam() > 500;
  EXPECT_EQ(events, is_reported ? std::vector{kind::spinning_up} : std::vector<kind>{});
}

INSTANTIATE_TEST_SUITE_P(OfMilliseconds, spin_up, testing::Values(0, 300, 1500, 2500, 9000));

/// Reads until the lidar is given up; the time that this took, or 0 if it is not given up.
std::int64_t given_up_ns(const sim::fault& fault, std::int64_t silence_ns) {
  sim::device_options device;
  device.silence_ns = silence_ns;
  sim::device simulated(sim::built_in_world(), device, {&fault, 1});
  sim::virtual_clock clock;
  auto lidar = lidar::open(std::make_unique<sim::virtual_connector>(simulated, clock));
  if (!lidar || !lidar->start()) return 0;
  const std::int64_t started_ns = clock.now_ns();
  while (clock.now_ns() < started_ns + 100 * second) {
    const auto found = lidar->try_scan(500ms);
    if (found || !found.error().is_fatal()) continue;
    EXPECT_EQ(found.error().code(), problem::brown_out) << found.error().message();
    return clock.now_ns() - started_ns;
  }
  return 0;
}

TEST(SpinUp, DeviceThatDiesDuringSpinUp_IsGivenUp) {
  // Silent for 10 s, then it does not answer any more.
  const std::int64_t dead_ns = given_up_ns(sim::make_fault(sim::fault_kind::brown_out), second);
  EXPECT_GT(dead_ns, 10 * second);
  EXPECT_LT(dead_ns, 13 * second);
  // It boots each time, and confirms the start again: silent for 10 s, twice.
  const std::int64_t boots_ns = given_up_ns(sim::make_fault(sim::fault_kind::reboot), second);
  EXPECT_GT(boots_ns, 20 * second);
  EXPECT_LT(boots_ns, 23 * second);
}

/// It needs longer to its first packet than its protection lasts, and the driver does not know that the
/// protection is on: it finds that out after each reconnect.
TEST(SpinUp, SlowDeviceUnderUnknownProtection_StartsAfterEachReconnect) {
  sim::device_options options;
  options.header_ns = 1400 * ms;
  options.silence_ns = 1900 * ms;
  options.initial.protection = power_down_protection::on;
  const sim::fault unplug = sim::make_fault(sim::fault_kind::unplug, 20 * second, 500 * ms);
  sim::device simulated(sim::built_in_world(), options, {&unplug, 1});
  sim::virtual_clock clock;
  lidar_options wanted;
  wanted.reconnect = true;
  auto lidar = lidar::open(std::make_unique<sim::virtual_connector>(simulated, clock), wanted);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  std::int64_t last_ns = 0;
  while (clock.now_ns() < 50 * second) {
    if (lidar->try_scan(500ms)) last_ns = clock.now_ns();
  }
  EXPECT_EQ(lidar->counts().reconnects, 1U);
  EXPECT_GT(last_ns, 49 * second);
}

/// The same after a restart by the program, which makes the protection unknown again: the one silent scan
/// that follows is started again, as after open().
TEST(SpinUp, SlowDeviceUnderUnknownProtection_StartsAfterARestart) {
  sim::device_options options;
  options.header_ns = 1400 * ms;
  options.silence_ns = 1900 * ms;
  options.initial.protection = power_down_protection::on;
  sim::device simulated(sim::built_in_world(), options);
  sim::virtual_clock clock;
  auto lidar = lidar::open(std::make_unique<sim::virtual_connector>(simulated, clock), {});
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  const auto has_scan = [&] {
    for (int i = 0; i < 40; ++i) {
      if (lidar->try_scan(500ms)) return true;
    }
    return false;
  };
  ASSERT_TRUE(has_scan());
  ASSERT_TRUE(lidar->ask(requests::restart(), while_scanning::stop_and_resume));
  EXPECT_TRUE(has_scan());
  while (const auto event = lidar->next_event()) EXPECT_NE(event->what, lidar_event::kind::lost);
}

}  // namespace
}  // namespace g4lidar::test
