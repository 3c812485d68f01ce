// SPDX-License-Identifier: MIT
// The acceptance run with simulated lidars, in virtual time: what it reports of a healthy one.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "acceptance_bench.hpp"

namespace g4lidar::test {
namespace {

using enum acceptance_verdict;

using bench = acceptance_bench;
using enum acceptance_step;

class AcceptanceOf : public testing::TestWithParam<std::string_view> {};

TEST_P(AcceptanceOf, AHealthyOne_NothingDiffers) {
  bench of(GetParam());
  const auto all = of.run();
  ASSERT_EQ(all.size(), acceptance_step_count);
  for (const acceptance_result& each : all) {
    EXPECT_NE(each.outcome, differs) << name_of(each.step) << '\n' << all_of(all);
  }
  EXPECT_GT(number_of(at(all, stream), "packets"), 100.0) << all_of(all);
  EXPECT_EQ(number_of(at(all, near_target), "measured_mm"), 800.0) << all_of(all);
  EXPECT_NEAR(number_of(at(all, near_target), "robot_bearing_deg"), 0.0, 2.0) << all_of(all);
  const bool is_one_way = of.options.one_way;
  EXPECT_EQ(at(all, start_and_stop).outcome == not_done, is_one_way) << all_of(all);
  EXPECT_TRUE(is_one_way || !of.motor_turns);
  EXPECT_EQ(of.settings.protection, power_down_protection::off);
}

INSTANTIATE_TEST_SUITE_P(All, AcceptanceOf, testing::ValuesIn(sim::model_words()),
                         [](const auto& of) {
                           std::string name(of.param);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(Acceptance, TheSettingsAreAsBefore) {
  bench of("g4");
  const auto before = of.options.scanner.sample_rate = g4lidar::sample_rate::khz_8;
  const auto all = of.run();
  EXPECT_EQ(of.settings.sample_rate, before) << all_of(all);
  EXPECT_EQ(of.settings.scan_frequency_chz, of.options.scanner.scan_frequency_chz);
}

TEST(Acceptance, EachQuestionHasAStepThatIsDone) {
  bench of("g4");
  const auto all = of.run();
  std::set<acceptance_step> asked;
  for (const open_question& each : open_questions()) asked.insert(each.step);
  EXPECT_EQ(asked.size(), acceptance_step_count);
  for (const acceptance_result& each : all) {
    EXPECT_FALSE(each.text.empty()) << name_of(each.step);
    const bool has_evidence = !each.measurements.empty();
    EXPECT_TRUE(has_evidence || each.outcome == not_done) << name_of(each.step);
  }
}

TEST(Acceptance, WithoutAModel_ItIsTheOneThatTheLidarShows) {
  for (const std::string_view word : {"g4", "x4", "t-mini-pro", "tg30", "s4b"}) {
    bench of(word);
    of.expected = "";
    const auto all = of.run();
    for (const acceptance_result& each : all) {
      EXPECT_NE(each.outcome, differs) << word << name_of(each.step) << '\n' << all_of(all);
    }
    EXPECT_EQ(at(all, identity).outcome, agrees) << word << all_of(all);
    EXPECT_GT(number_of(at(all, stream), "packets"), 100.0) << word << all_of(all);
  }
}

TEST(Acceptance, WithoutAModel_BytesOfSeveralAreRefused) {
  bench of("x2");
  of.expected = "";
  const auto all = of.run();
  ASSERT_EQ(all.size(), acceptance_step_count);
  for (const acceptance_result& each : all) {
    EXPECT_EQ(each.outcome, not_done) << name_of(each.step);
    for (const std::string_view word : {"x2", "x2l", "x3"}) {
      EXPECT_NE(each.text.find(word), std::string::npos) << each.text;
    }
  }
}

TEST(Acceptance, AUserWhoDeclines_OnlyHisStepsAreLeftOut) {
  bench of("g4");
  of.declines = true;
  const auto all = of.run();
  for (const acceptance_result& each : all) {
    const bool needs_user = each.step >= near_target;
    const bool is_possible = each.step != acceptance_step::unplug;
    EXPECT_EQ(each.outcome == not_done, needs_user) << name_of(each.step) << is_possible;
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
      sim::make_fault(sim::fault_kind::stall, first.stream_began_ns + after_ns, 1'000'000'000)};
  const auto all = of.run();
  EXPECT_EQ(at(all, stream).outcome, agrees) << all_of(all);
  EXPECT_NEAR(number_of(at(all, stream), "sample_rate_hz"), 9000.0, 90.0) << all_of(all);
}

TEST(Acceptance, Cancelled_TheLidarIsStopped) {
  bench of("g4");
  of.cancels = true;
  const auto all = of.run();
  EXPECT_EQ(at(all, stream).text, "Interrupted.");
  EXPECT_FALSE(of.motor_turns);
}

TEST(Acceptance, WithoutALidar_TheReasonIsStated) {
  sim::device simulated(sim::built_in_world());
  sim::virtual_clock clock;
  sim::virtual_connector from(simulated, clock);
  simulated.unplug(1);
  const auto all = run_acceptance(from, {});
  ASSERT_EQ(all.size(), acceptance_step_count);
  EXPECT_EQ(all.front().outcome, not_done);
  EXPECT_NE(all.front().text.find("virtual:g4"), std::string::npos) << all.front().text;
}

}  // namespace
}  // namespace g4lidar::test
