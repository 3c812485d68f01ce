// SPDX-License-Identifier: MIT
// The text form of faults, and invalid texts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "g4lidar/sim/device.hpp"

namespace {

using namespace g4lidar::sim;
using ::testing::HasSubstr;

fault read(std::string_view text) {
  const auto found = parse_fault(text);
  if (const auto* wrong = std::get_if<fault_error>(&found)) {
    ADD_FAILURE() << text << ": " << wrong->message;
    return make_fault(fault_kind::flip);
  }
  return std::get<fault>(found);
}

std::string refusal(std::string_view text) {
  const auto found = parse_fault(text);
  const auto* wrong = std::get_if<fault_error>(&found);
  return wrong == nullptr ? "nothing" : wrong->message;
}

TEST(SimFaultText, EveryKind_HasANameAndDefaults) {
  for (int kind = 0; kind <= static_cast<int>(last_fault_kind); ++kind) {
    const auto expected = make_fault(static_cast<fault_kind>(kind));
    const fault found = read(name_of(expected.kind));
    EXPECT_EQ(found.kind, expected.kind);
    EXPECT_EQ(found.begin_ns, 0);
    EXPECT_EQ(found.duration_ns, forever_ns);
    EXPECT_EQ(found.rate, expected.rate);
    EXPECT_EQ(found.amount, expected.amount);
    EXPECT_EQ(problem_with(found), "");
  }
}

TEST(SimFaultText, ParsesBeginAndDuration) {
  const fault f = read("unplug@5s+2s");
  EXPECT_EQ(f.kind, fault_kind::unplug);
  EXPECT_EQ(f.begin_ns, 5'000'000'000);
  EXPECT_EQ(f.duration_ns, 2'000'000'000);
  EXPECT_EQ(read("stall@0").begin_ns, 0);
  EXPECT_EQ(read("stall@30ns").begin_ns, 30);
  EXPECT_EQ(read("stall@200us").begin_ns, 200'000);
  EXPECT_EQ(read("stall@1.5ms").begin_ns, 1'500'000);
  EXPECT_EQ(read("stall@2min").begin_ns, 120'000'000'000);
  EXPECT_EQ(read("stall@0.000001s").begin_ns, 1'000);
}

TEST(SimFaultText, ParsesRateAndAmount) {
  EXPECT_EQ(read("flip*0.001").rate, 0.001);
  EXPECT_EQ(read("flip*0.5%").rate, 0.005);
  EXPECT_EQ(read("late=120ms*1").amount, 120'000'000);
  const fault all = read("burst=30*0.01%@500ms+1s");
  EXPECT_EQ(all.amount, 30);
  EXPECT_EQ(all.rate, 0.0001);
  EXPECT_EQ(all.begin_ns, 500'000'000);
  EXPECT_EQ(all.duration_ns, 1'000'000'000);
  EXPECT_EQ(read("health=warning").amount, 1);
  EXPECT_EQ(read("health=2").amount, 2);
  EXPECT_EQ(read("mute=93").amount, 0x93);
  EXPECT_EQ(read("wrong=0D*0.5@1s").amount, 0x0D);
  EXPECT_EQ(read("twice=d9").amount, 0xD9);
  EXPECT_EQ(read("mute").amount, 0);
}

TEST(SimFaultText, InvalidTexts_AreRefused) {
  EXPECT_THAT(refusal(""), HasSubstr("'' is not a fault; faults are flip, drop,"));
  EXPECT_THAT(refusal("Flip"), HasSubstr("'Flip' is not a fault"));
  EXPECT_EQ(refusal("unplug=3"), "'unplug' takes no amount");
  EXPECT_EQ(refusal("unplug*0.5"), "'unplug' takes no rate");
  EXPECT_EQ(refusal("flip*2"), "the rate of a fault must be 0 to 1");
  EXPECT_EQ(refusal("flip*x"), "'x' is no rate: 0 to 1, or 0% to 100%");
  EXPECT_EQ(refusal("flip*-1"), "'-1' is no rate: 0 to 1, or 0% to 100%");
  EXPECT_EQ(refusal("burst=0"), "a burst must have 1 to 1000000 bytes");
  EXPECT_EQ(refusal("burst=1.5"), "'1.5' is no amount for burst");
  EXPECT_EQ(refusal("batch=16"), "'16' is no amount for batch");
  for (const char* const code : {"9", "193", "0x93", "G3", "00", ""}) {
    EXPECT_EQ(refusal(std::string("mute=") + code),
              "'" + std::string(code) + "' is no amount for mute");
  }
  EXPECT_EQ(refusal("late=1min"), "a fault's time must be 0 to 4 s");
  EXPECT_EQ(refusal("health=3"), "the health must be 0, 1 or 2");
  for (const char* when : {"", "5", "s", "1,5s", "-1s", "1.s", ".5s", "1s ", "9999999999s",
                           "999999999s", "1h", "1.0000001s"}) {
    EXPECT_THAT(refusal(std::string("stall@") + when), HasSubstr("is no time")) << when;
    EXPECT_THAT(refusal(std::string("stall@1s+") + when), HasSubstr("is no time")) << when;
  }
}

}  // namespace
