// SPDX-License-Identifier: MIT
// What the kit reports of healthy simulated lidars.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "bench.hpp"

namespace g4_tool::acceptance::test {
namespace {

using enum finding;
using enum step;

void expect_no_difference(const std::vector<step_result>& all) {
  ASSERT_EQ(all.size(), step_count);
  for (const step_result& each : all)
    EXPECT_NE(each.outcome, differs) << name_of(each.of) << '\n' << all_of(all);
}

class AcceptanceOf : public testing::TestWithParam<std::string_view> {};

TEST_P(AcceptanceOf, AHealthyOne_NothingDiffers) {
  bench of(GetParam());
  const auto all = of.run();
  expect_no_difference(all);
  EXPECT_GT(number_of(at(all, stream), "packets"), 100.0) << all_of(all);
  EXPECT_EQ(number_of(at(all, near_target), "measured_mm"), 800.0) << all_of(all);
  EXPECT_NEAR(number_of(at(all, near_target), "robot_bearing_deg"), 0.0, 2.0) << all_of(all);
  const bool is_one_way = of.options.one_way;
  EXPECT_EQ(at(all, start_and_stop).outcome == not_done, is_one_way) << all_of(all);
  EXPECT_TRUE(is_one_way || !of.motor_turns);
  EXPECT_EQ(of.settings, sim::device(sim::built_in_world(), of.options).settings());
  EXPECT_EQ(of.lost_settings, "");
}

INSTANTIATE_TEST_SUITE_P(All, AcceptanceOf, testing::ValuesIn(sim::model_words()),
                         [](const auto& of) { return test_name(of.param); });

TEST(Acceptance, SomeDevicesOfTheModelHaveOtherSamples_NothingDiffers) {
  for (const std::string_view word : {"s2", "s2-pro", "s2-intensity", "s2-pro-intensity"}) {
    bench of(word);
    ASSERT_TRUE(sim::use_model(of.options, word, true));
    expect_no_difference(of.run());
  }
}

TEST(Acceptance, OldFirmware_NothingDiffers) {
  for (const auto& [word, minor] : {std::pair{"tg15", 2}, {"tg30", 1}, {"r2", 7}}) {
    bench of(word);
    of.options.info.firmware_major = 1;
    of.options.info.firmware_minor = static_cast<std::uint8_t>(minor);
    ASSERT_TRUE(sim::use_model(of.options, word));
    of.options.zero_angle_cdeg = 3000;
    expect_no_difference(of.run());
  }
}

TEST(Acceptance, TheSecondRateOfTheModel_NothingDiffers) {
  bench of("s2-pro");
  of.options.baud = 128'000;
  const auto all = of.run();
  expect_no_difference(all);
  EXPECT_EQ(number_of(at(all, listening), "found_baud"), 128'000.0) << all_of(all);
}

TEST(Acceptance, EachStepIsDoneAndEachAnswersSomething) {
  bench of("g4");
  const auto all = of.run();
  std::set<step> asked;
  for (const question_row& each : question_rows()) asked.insert(each.asked_by);
  EXPECT_EQ(asked.size(), step_count);
  for (const step_result& each : all) {
    EXPECT_FALSE(each.text.empty()) << name_of(each.of);
    const bool has_facts = !each.facts.empty();
    EXPECT_TRUE(has_facts || each.outcome == not_done) << name_of(each.of);
  }
}

TEST(Acceptance, EachFactThatIsCheckedIsStatedByAStep) {
  std::set<std::pair<step, std::string_view>> missing;
  for (const check_row& each : check_rows()) missing.insert({each.of, each.fact});
  for (const std::string_view word : {"g4", "x4-pro", "s2", "x4"}) {
    bench of(word);
    if (word == "s2") of.options.baud = 128'000;
    const auto all = of.run();
    for (const step_result& each : all)
      for (const evidence& fact : each.facts) missing.erase({each.of, fact.name});
  }
  missing.erase(
      {identity, "found_baud"});  // of a two-way lidar at another rate: a planted difference
  for (const auto& [of, fact] : missing) ADD_FAILURE() << name_of(of) << ' ' << fact;
}

TEST(Acceptance, AUserWhoDeclines_OnlyHisStepsAreLeftOut) {
  bench of("g4");
  of.declines = true;
  for (const step_result& each : of.run()) {
    const bool needs_user = each.of >= near_target;
    EXPECT_EQ(each.outcome == not_done, needs_user) << name_of(each.of);
  }
}

// As on a computer that is busy: a short scan with a pause has no rate.
TEST(Acceptance, APauseInAShortScan_IsNoDifference) {
  bench first("g4");
  first.stream_time = std::chrono::seconds(2);
  static_cast<void>(first.run());
  constexpr std::int64_t after_ns = 3'500'000'000;  // when the motor has spun up
  bench of("g4");
  of.stream_time = first.stream_time;
  of.faults = {
      sim::make_fault(sim::fault_kind::stall, first.begun_ns[stream] + after_ns, 1'000'000'000)};
  const auto all = of.run();
  EXPECT_EQ(at(all, stream).outcome, agrees) << all_of(all);
  EXPECT_NEAR(number_of(at(all, stream), "sample_rate_hz"), 9000.0, 90.0) << all_of(all);
}

// As where the computer was busy before: what had waited comes at once.
TEST(Acceptance, WhatHadWaitedBeforeAShortScan_IsNoDifference) {
  bench first("g4");
  first.stream_time = std::chrono::seconds(2);
  static_cast<void>(first.run());
  // Up to the end of the scan, in which all comes at one time then.
  for (std::int64_t length_ns = 100'000'000; length_ns < 2'600'000'000; length_ns += 100'000'000) {
    bench of("g4");
    of.stream_time = first.stream_time;
    of.faults = {
        sim::make_fault(sim::fault_kind::stall, first.begun_ns[stream] + 2'800'000'000, length_ns)};
    const auto all = of.run();
    EXPECT_EQ(at(all, stream).outcome, agrees) << length_ns << all_of(all);
    EXPECT_NEAR(number_of(at(all, stream), "sample_rate_hz"), 9000.0, 90.0) << length_ns;
  }
}

TEST(Acceptance, AComputerThatIsAlwaysBusy_MeasuresNoRates) {
  bench of("g4");
  of.stream_time = std::chrono::seconds(2);
  constexpr std::int64_t each_ns = 700'000'000;
  for (std::int64_t begin_ns = 0; begin_ns < 300'000'000'000; begin_ns += each_ns)
    of.faults.push_back(sim::make_fault(sim::fault_kind::stall, begin_ns, each_ns / 2));
  const auto all = of.run();
  for (const step each : {sample_rate, stream}) {
    EXPECT_EQ(at(all, each).outcome, observed) << all_of(all);
    EXPECT_NE(at(all, each).text.find("too busy"), std::string::npos) << all_of(all);
  }
  for (const char* const rate : {"sample_rate_hz", "frequency_hz", "offset_hz"})
    EXPECT_EQ(number_of(at(all, stream), rate), -1.0) << all_of(all);
}

// A motor stands for 60 ms, and reaches its 7 Hz with a constant acceleration. A revolution of it takes 143 ms.
TEST(Acceptance, SteadyAfter_IsWhenTheMotorHasItsSpeed) {
  for (const std::uint32_t mhz_per_s : {14'000U, 4'667U}) {
    bench of("g4");
    of.options.acceleration_mhz_per_s = mhz_per_s;
    const auto all = of.run();
    const double true_ms = 60.0 + 7.0e6 / mhz_per_s;
    const double found_ms = number_of(at(all, start_and_stop), "steady_after_ms");
    EXPECT_GT(found_ms, true_ms - 100.0) << all_of(all);
    EXPECT_LT(found_ms, true_ms + 200.0) << all_of(all);
  }
}

TEST(Acceptance, WithoutALidar_TheReasonIsStated) {
  sim::device simulated(sim::built_in_world());
  sim::virtual_clock clock;
  sim::virtual_connector from(simulated, clock);
  simulated.unplug(1);
  const report all = run(from, {});
  EXPECT_TRUE(all.steps.empty());
  ASSERT_TRUE(all.failure.has_value());
  EXPECT_NE(all.failure->message().find("virtual:g4"), std::string::npos);
}

}  // namespace
}  // namespace g4_tool::acceptance::test
