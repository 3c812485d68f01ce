// SPDX-License-Identifier: MIT
// The options of the device that delay its first answer, its scan header, its first packet and its stop.
#include <gtest/gtest.h>

#include <cstdint>

#include "g4lidar/sim/device.hpp"
#include "support/host_side.hpp"

namespace {

using namespace g4lidar;
using test::host_side;
using test::ms;
using test::taken_apart;

/// More than the transmission of a command and its answer, and the delay of a bridge.
constexpr std::int64_t slack_ns = 10 * ms;

TEST(SimStartTimes, OnlyTheFirstAnswerAfterABoot_IsLate) {
  sim::device_options options;
  options.first_answer_ns = 700 * ms;
  options.boot_ns = 100 * ms;
  options.boots_at_start = true;
  options.boot_text = options.boot_information = false;
  host_side host(options);
  EXPECT_TRUE(host.listen(200 * ms).empty());
  host.send(0x90);
  EXPECT_TRUE(host.listen(699 * ms).empty());
  EXPECT_FALSE(host.listen(slack_ns).empty());
  host.send(0x90);
  EXPECT_FALSE(host.listen(slack_ns).empty());
}

TEST(SimStartTimes, Header_IsLateAndPacketsFollow) {
  sim::device_options options;
  options.header_ns = 800 * ms;
  host_side host(options);
  host.send(0x60);
  EXPECT_TRUE(host.listen(799 * ms).empty());
  const auto header = taken_apart(host.listen(slack_ns));
  ASSERT_FALSE(header.responses.empty());
  EXPECT_EQ(header.responses.front(), response_kind::scan_started);
  EXPECT_GT(taken_apart(host.listen(500 * ms)).packets, 0U);
}

TEST(SimStartTimes, Stop_CancelsALateHeader) {
  sim::device_options options;
  options.header_ns = 800 * ms;
  host_side host(options);
  host.send(0x60);
  EXPECT_TRUE(host.listen(100 * ms).empty());
  host.send(0x65);
  EXPECT_TRUE(taken_apart(host.listen(2'000 * ms)).responses.empty());
}

TEST(SimStartTimes, SpinUp_IsSilentAfterTheHeader) {
  sim::device_options options;
  options.silence_ns = 2'500 * ms;
  host_side host(options);
  host.send(0x60);
  const auto header = taken_apart(host.listen(2'490 * ms));
  EXPECT_EQ(header.responses.size(), 1U);
  EXPECT_EQ(header.packets, 0U);
  EXPECT_GT(taken_apart(host.listen(100 * ms)).packets, 0U);
}

/// Sends a start, and after this time a stop.
void start_and_stop(host_side& host, std::int64_t after_ns) {
  host.send(0x60);
  static_cast<void>(host.listen(after_ns));
  host.send(0x65);
}

TEST(SimStartTimes, Stop_EndsTheScanLater) {
  sim::device_options options;
  options.stop_ns = 300 * ms;
  host_side host(options);
  start_and_stop(host, 1'000 * ms);
  static_cast<void>(host.listen(200 * ms));
  host.send(0x65);  // does not delay it
  EXPECT_GT(taken_apart(host.listen(99 * ms)).packets, 10U);
  EXPECT_TRUE(host.device.is_scanning());
  static_cast<void>(host.listen(slack_ns));
  EXPECT_FALSE(host.device.is_scanning());
  EXPECT_TRUE(host.listen(1'000 * ms).empty());
  EXPECT_FALSE(host.device.motor_turns());
}

TEST(SimStartTimes, Stop_DuringSpinUp_IsNotLate) {
  sim::device_options options;
  options.stop_ns = 300 * ms;
  options.silence_ns = 500 * ms;
  host_side host(options);
  start_and_stop(host, 400 * ms);
  EXPECT_TRUE(host.listen(1'000 * ms).empty());
}

TEST(SimStartTimes, StartBeforeTheEnd_CancelsALateStop) {
  sim::device_options options;
  options.stop_ns = 300 * ms;
  host_side host(options);
  start_and_stop(host, 1'000 * ms);
  static_cast<void>(host.listen(100 * ms));
  host.send(0x60);
  static_cast<void>(host.listen(1'000 * ms));
  EXPECT_GT(taken_apart(host.listen(100 * ms)).packets, 10U);
  EXPECT_TRUE(host.device.is_scanning());
}

}  // namespace
