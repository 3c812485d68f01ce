// SPDX-License-Identifier: MIT
// Each command of the protocol, and its exact reply.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>

#include "g4lidar/sim/device.hpp"
#include "support/host_side.hpp"

namespace {

using namespace g4lidar;
using test::byte_vector;
using test::host_side;
using test::ms;
using test::second;
using ::testing::IsEmpty;

byte_vector byte_answer(std::uint8_t value) {
  return {0xA5, 0x5A, 0x01, 0x00, 0x00, 0x00, 0x04, value};
}

byte_vector frequency_answer(unsigned chz) {
  return {0xA5,
          0x5A,
          0x04,
          0x00,
          0x00,
          0x00,
          0x04,
          static_cast<std::uint8_t>(chz & 0xFFU),
          static_cast<std::uint8_t>(chz >> 8),
          0x00,
          0x00};
}

const byte_vector healthy{0xA5, 0x5A, 0x03, 0x00, 0x00, 0x00, 0x06, 0x00, 0x00, 0x00};
// The example of the protocol page: firmware 3.2, hardware 3, serial 2021101000070073.
const byte_vector information{0xA5, 0x5A, 0x14, 0x00, 0x00, 0x00, 0x04, 0x05, 0x02,
                              0x03, 0x03, 0x02, 0x00, 0x02, 0x01, 0x01, 0x00, 0x01,
                              0x00, 0x00, 0x00, 0x00, 0x07, 0x00, 0x00, 0x07, 0x03};

TEST(SimCommands, DeviceInformationAndHealth) {
  host_side host;
  EXPECT_EQ(host.ask(0x90), information);
  EXPECT_EQ(host.ask(0x91), healthy);
  EXPECT_EQ(host.ask(0x92), healthy);
  sim::device_options ill;
  ill.condition = {health_status::warning, 0x1234};
  const byte_vector warning{0xA5, 0x5A, 0x03, 0x00, 0x00, 0x00, 0x06, 0x01, 0x34, 0x12};
  EXPECT_EQ(host_side(ill).ask(0x91), warning);
}

// Bytes that do not fit into its buffer are lost: the next program gets an answer at once.
TEST(SimCommands, Flood_DelaysTheAnswersByTheBufferOnly) {
  host_side host;
  host.device.write(byte_vector(1'000'000, 'x'), host.now_ns);
  EXPECT_THAT(host.listen(100 * ms), IsEmpty());
  EXPECT_EQ(host.ask(0x90), information);
}

TEST(SimCommands, LowPower_ControlsTheIdleMotor) {
  host_side host;
  EXPECT_EQ(host.ask(0x05), byte_answer(1));
  EXPECT_FALSE(host.device.motor_turns());
  EXPECT_EQ(host.ask(0x02), byte_answer(0));
  EXPECT_EQ(host.ask(0x05), byte_answer(0));
  EXPECT_TRUE(host.device.motor_turns());
  EXPECT_TRUE(host.device.is_idle_and_silent(host.now_ns));
  EXPECT_EQ(host.ask(0x01), byte_answer(1));
  EXPECT_FALSE(host.device.motor_turns());
}

TEST(SimCommands, Direction) {
  host_side host;
  EXPECT_EQ(host.ask(0x08), byte_answer(0));
  EXPECT_EQ(host.ask(0x07), byte_answer(1));
  EXPECT_EQ(host.ask(0x08), byte_answer(1));
  EXPECT_EQ(host.ask(0x06), byte_answer(0));
  EXPECT_EQ(host.ask(0x08), byte_answer(0));
}

TEST(SimCommands, ScanFrequency_HasLimits) {
  for (const sim::at_limit limit : {sim::at_limit::clamp, sim::at_limit::refuse}) {
    sim::device_options options;
    options.scanner.scan_frequency_chz = 1150;
    options.frequency_at_limit = limit;
    host_side host(options);
    const bool clamps = limit == sim::at_limit::clamp;
    EXPECT_EQ(host.ask(0x0B), frequency_answer(clamps ? 1200 : 1150));
    for (int i = 0; i < 7; ++i) (void)host.ask(0x0C);
    EXPECT_EQ(host.ask(0x0D), frequency_answer(clamps ? 500 : 550));
    EXPECT_EQ(host.ask(0x0C), frequency_answer(clamps ? 500 : 550));
  }
}

TEST(SimCommands, ConstantFrequency) {
  host_side host;
  EXPECT_EQ(host.ask(0x0F), byte_answer(0));
  EXPECT_EQ(host.device.settings().constancy, constant_frequency::off);
  EXPECT_EQ(host.ask(0x0E), byte_answer(1));
  EXPECT_EQ(host.device.settings().constancy, constant_frequency::on);
}

TEST(SimCommands, Protection_TogglesAndAnswers) {
  host_side host;
  EXPECT_EQ(host.ask(0xD9), byte_answer(0));
  EXPECT_EQ(host.device.settings().protection, power_down_protection::on);
  EXPECT_EQ(host.ask(0xD9), byte_answer(1));
}

TEST(SimCommands, StopsAreNotAnswered) {
  host_side host;
  EXPECT_THAT(host.ask(0x65), IsEmpty());
  EXPECT_THAT(host.ask(0x00), IsEmpty());
}

TEST(SimCommands, OldFirmware_DoesNotAnswerEverything) {
  sim::device_options old;
  old.answers_direction = old.answers_health_91 = old.answers_health_92 = false;
  old.obeys_restart_80 = false;
  host_side host(old);
  EXPECT_THAT(host.ask(0x08), IsEmpty());
  EXPECT_THAT(host.ask(0x91), IsEmpty());
  EXPECT_THAT(host.ask(0x92), IsEmpty());
  EXPECT_THAT(host.ask(0x80, second), IsEmpty());
  for (const sim::asked& what : host.device.log()) EXPECT_FALSE(what.obeyed);
  EXPECT_FALSE(host.ask(0x40, second).empty());
}

TEST(SimCommands, UnknownCommands_AreIgnored) {
  host_side host;
  for (int code = 0; code < 256; ++code) {
    if (traits_of(static_cast<command>(code)) || code == 0xA5) continue;
    ASSERT_THAT(host.ask(static_cast<std::uint8_t>(code), 5 * ms), IsEmpty()) << code;
  }
  // Bytes without a start byte are no commands, and two start bytes count as one.
  host.device.write(byte_vector{0x90, 0x12, 0xA5, 0xA5, 0x90}, host.now_ns);
  EXPECT_EQ(host.listen(50 * ms), information);
}

TEST(SimCommands, Answers_AreSentInSequence) {
  host_side host;
  host.device.write(byte_vector{0xA5, 0x90, 0xA5, 0x91}, host.now_ns);
  byte_vector both = information;
  both.insert(both.end(), healthy.begin(), healthy.end());
  EXPECT_EQ(host.listen(50 * ms), both);
}

TEST(SimCommands, AreLoggedWithTheirTimes) {
  sim::device_options options;
  options.log_capacity = 3;
  host_side host(options);
  host.listen(10 * ms);
  (void)host.ask(0x90);
  (void)host.ask(0x77);
  ASSERT_EQ(host.device.log().size(), 2U);
  EXPECT_EQ(host.device.log()[0].code, 0x90);
  EXPECT_TRUE(host.device.log()[0].obeyed);
  EXPECT_NEAR(static_cast<double>(host.device.log()[0].time_ns), 10e6 + 2 * 43403.0, 10.0);
  EXPECT_FALSE(host.device.log()[1].obeyed);
  (void)host.ask(0x90);
  (void)host.ask(0x90);
  EXPECT_EQ(host.device.log().size(), 3U);
  EXPECT_EQ(host.device.log_missed(), 1U);
  host.device.clear_log();
  EXPECT_THAT(host.device.log(), IsEmpty());
}

}  // namespace
