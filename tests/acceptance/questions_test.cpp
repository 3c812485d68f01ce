// SPDX-License-Identifier: MIT
// The open questions: an acceptance run answers what its measurements decide, and nothing else. The right
// answers are those of the simulator's options.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "bench.hpp"

namespace g4_tool::acceptance::test {
namespace {

using enum question_answer::state;

/// What a run with a healthy simulated lidar decides: "a" answered, "-" not applicable, "." not decided, in
/// the order of the questions. Two-way models with the commands of a G4; with some of them; with a motor
/// that DTR drives; one-way models with such a motor, and without.
struct decided {
  std::string_view word;
  std::string_view states;
};

constexpr decided by_models[] = {
    // clang-format off
    //               bridge unasked number one-way optional 93 health D9 limits codes lengths 00 spin edge cut
    //               frequency layout bits flags CT time zero unit settings
    {"g4",               ".aa-a-.aaaaaa--aaa-aaaaa"},
    {"g2",               ".aa-aa.aa-aaa--aaa-aa.aa"},
    {"t-mini-pro",       ".aa-a-.aa-aaa--aaa.aaaaa"},
    {"t-mini-plus-sh",   ".aa-a-.aa-aaa--aaa-aaaaa"},
    {"tg30",             ".aa-aa.aa-aaa--aaa-aa.aa"},
    {"f4",               ".aa-a-.-a-aaa--aaa-aaaaa"},
    {"x4",               ".aa-a-.---aaaaaaaa.aaaa-"},
    {"s4",               ".aa-a-.---aaaaaaaa.aaaa-"},
    {"x2",               ".a.a------a-aaaaaa.aaaa-"},
    {"tx8",              ".a.a------a-aaaaaa-aaaa-"},
    {"x4-pro",           ".aaa------a-a--aaa.aaaa-"},
    // clang-format on
};

class QuestionsOf : public testing::TestWithParam<decided> {};

TEST_P(QuestionsOf, AHealthyOne) {
  bench of(GetParam().word);
  const auto all = of.run();
  const auto answers = answers_of(*model_named(of.expected), all);
  ASSERT_EQ(answers.size(), question_rows().size());
  std::string states;
  for (const question_answer& each : answers) {
    states += each.how == answered ? 'a' : each.how == does_not_arise ? '-' : '.';
    EXPECT_FALSE(each.text.empty());
  }
  EXPECT_EQ(states, GetParam().states) << all_of(all);
  constexpr double most_seconds = 20.0 * 60.0;
  EXPECT_LT(static_cast<double>(of.end_ns) / 1e9 + 50.0, most_seconds)
      << "with a minute of the stream";
}

INSTANTIATE_TEST_SUITE_P(Some, QuestionsOf, testing::ValuesIn(by_models),
                         [](const auto& of) { return test_name(of.param.word); });

/// A lidar or a user, a question, and the beginning of the right answer.
struct asked_for {
  std::string_view name;
  std::string_view word;
  std::function<void(bench&)> set_up;
  std::string_view question;
  question_answer::state how;
  std::string_view text;
};

class Answer : public testing::TestWithParam<asked_for> {};

TEST_P(Answer, IsTheRightOne) {
  bench of(GetParam().word);
  GetParam().set_up(of);
  const auto all = of.run();
  const question_answer found = answer_to(of, all, GetParam().question);
  EXPECT_EQ(found.how, GetParam().how) << all_of(all);
  EXPECT_NE(found.text.find(GetParam().text), std::string::npos) << found.text << all_of(all);
}

auto dtr_by(sim::dtr_start by) {
  return [by](bench& of) { of.options.dtr_starts_by = by; };
}
auto dtr_cuts(sim::dtr_cut what) {
  return [what](bench& of) { of.options.dtr_cuts = what; };
}
/// 93 answers this; by the device's angles zero is this much farther.
auto zero_at(std::int32_t answered_cdeg, double ahead_deg) {
  return [=](bench& of) {
    of.options.zero_angle_cdeg = answered_cdeg;
    of.ahead_deg = ahead_deg;
  };
}

constexpr std::string_view by_level = "starts_by the level of DTR";
constexpr std::string_view by_edge = "starts_by an edge, that of an opened port";
constexpr std::string_view by_pulse = "starts_by an edge while the port is open";
const port_info cp2102 = [] {
  port_info made;
  made.path = "/dev/ttyUSB0";
  made.product = "CP2102";
  made.vendor_id = 0x10C4;
  made.product_id = 0xEA60;
  return made;
}();

const std::vector<asked_for> cases{
    {"X4ByTheLevel", "x4", dtr_by(sim::dtr_start::level), "edge of DTR", answered, by_level},
    {"X4ByAnEdge", "x4", dtr_by(sim::dtr_start::edge), "edge of DTR", answered, by_edge},
    {"X4ByAPulse", "x4", dtr_by(sim::dtr_start::pulse), "edge of DTR", answered, by_pulse},
    {"S4bByTheLevel", "s4b", dtr_by(sim::dtr_start::level), "edge of DTR", answered, by_level},
    {"S4bByAPulse", "s4b", dtr_by(sim::dtr_start::pulse), "edge of DTR", answered, by_pulse},
    {"X2ByTheLevel", "x2", dtr_by(sim::dtr_start::level), "edge of DTR", answered, by_level},
    {"X2ByAnEdge", "x2", dtr_by(sim::dtr_start::edge), "edge of DTR", answered, by_edge},
    {"X4WithoutPower", "x4", [](bench& of) { of.options.motor_has_power = false; }, "edge of DTR",
     open, "starts_with_edge is no"},
    {"TheLevelOfASupply", "x4",
     [](bench& of) {
       of.options.dtr_starts_by = sim::dtr_start::level;
       of.options.dtr_cuts = sim::dtr_cut::supply;
     },
     "edge of DTR", answered, by_level},
    {"X4Motor", "x4", dtr_cuts(sim::dtr_cut::motor), "supply of", answered, "dtr_switches motor"},
    {"X4Supply", "x4", dtr_cuts(sim::dtr_cut::supply), "supply of", answered,
     "dtr_switches supply"},
    {"X2Motor", "x2", dtr_cuts(sim::dtr_cut::motor), "supply of", answered, "dtr_switches motor"},
    {"X2Supply", "x2", dtr_cuts(sim::dtr_cut::supply), "supply of", answered,
     "dtr_switches supply"},
    {"X2MotorWithoutAnUnplug", "x2", [](bench& of) { of.declines = true; }, "supply of", open,
     "It sent no boot message"},
    {"SettingsAreKept", "g4", [](bench& of) { of.options.settings_outlive_power = true; },
     "outlive", answered, "settings_kept yes"},
    {"SettingsAreLost", "t-mini-pro", [](bench&) {}, "outlive", answered, "settings_kept no"},
    {"AnotherLidarCameBack", "g4",
     [](bench& of) {
       of.returns_as = of.options;
       of.returns_as->info.serial_digits[0] = '3';
     },
     "outlive", open, "same_lidar is no"},
    {"NoUnplug", "g4", [](bench& of) { of.declines = true; }, "outlive", open,
     "The user declined."},
    {"TheOffsetIsToBeAdded", "tg30", zero_at(3000, 0.0), "Where is zero", answered,
     "offset_is to be added"},
    {"TheOffsetIsApplied", "tg30", zero_at(3000, -30.0), "Where is zero", answered,
     "offset_is already applied"},
    {"TheOffsetIsToBeSubtracted", "tg30", zero_at(3000, -60.0), "Where is zero", answered,
     "offset_is to be subtracted"},
    {"TheOffsetDoesNotFit", "tg30", zero_at(3000, 45.0), "Where is zero", open,
     "does not show how it is used"},
    {"TheOffset", "g2", zero_at(3000, 0.0), "(93) contain", answered, "zero_offset_deg 30"},
    {"AHealthError", "g4", [](bench& of) { of.options.condition = {health_status::error, 0x0203}; },
     "error codes", answered, "status 2 with code 0203"},
    {"ABridge", "g4", [](bench& of) { of.port = &cp2102; }, "USB bridge", answered,
     "usb 10c4:ea60, wanted_baud 230400, set_baud 230400"},
    {"AShortStream", "g4", [](bench& of) { of.stream_time = std::chrono::milliseconds(300); },
     "time packets", open, "less than 10 s"},
    {"TimePackets", "g4",
     [](bench& of) {
       of.options.time_packet_ns = 100'000'000;
       of.stream_time = std::chrono::milliseconds(900);
     },
     "time packets", answered, "time_packets "},
    {"TooFewReturns", "x4", [](bench& of) { of.stream_time = std::chrono::milliseconds(150); },
     "lower bits", open, "not clear"},
    {"OneWayInsteadOfTwoWay", "g4", [](bench& of) { of.options = bench("x2").options; },
     "direction (08)", open, "is not answered"},
    {"ItWasScanning", "x4-pro",
     [](bench& of) {
       of.options = bench("x4").options;
       of.options.dtr_starts_by = sim::dtr_start::level;
       of.scans = true;
     },
     "before they are asked", open, "sends_after_65 is no"},
    {"TheUnitIsTwiceAsLarge", "x4",
     [](bench& of) {
       of.options.scanner.format.code.units_per_mm *= 2;
       of.options.scanner.max_range_mm = 5'000.0;
     },
     "unit of the range", answered, "range_ratio 2"},
};

INSTANTIATE_TEST_SUITE_P(Question, Answer, testing::ValuesIn(cases),
                         [](const auto& of) { return std::string(of.param.name); });

TEST(Questions, WithoutResults_NoneIsDecided) {
  for (const question_answer& each : answers_of(g4_model, {})) {
    EXPECT_NE(each.how, answered);
    EXPECT_FALSE(each.text.empty());
  }
}

}  // namespace
}  // namespace g4_tool::acceptance::test
