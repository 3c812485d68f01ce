// SPDX-License-Identifier: MIT
// The open questions: an acceptance run answers what its measurements decide, and nothing else. The right
// answers are those of the simulator's options.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acceptance_bench.hpp"

namespace g4lidar::test {
namespace {

using bench = acceptance_bench;
using q = acceptance_question;
using enum answer_state;

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
  const auto answers = answers_of(all);
  ASSERT_EQ(answers.size(), acceptance_question_count);
  std::string states;
  for (const question_answer& each : answers) {
    states += each.state == answered ? 'a' : each.state == not_applicable ? '-' : '.';
    EXPECT_FALSE(each.text.empty());
  }
  EXPECT_EQ(states, GetParam().states) << all_of(all);
  constexpr double most_seconds = 20.0 * 60.0;
  EXPECT_LT(of.seconds + 50.0, most_seconds) << "with a minute of the stream";
}

INSTANTIATE_TEST_SUITE_P(Some, QuestionsOf, testing::ValuesIn(by_models), [](const auto& of) {
  std::string name(of.param.word);
  std::ranges::replace(name, '-', '_');
  return name;
});

/// A lidar or a user, a question, and the beginning of the right answer.
struct asked_for {
  std::string_view name;
  std::string_view word;
  std::function<void(bench&)> set_up;
  q question;
  answer_state state;
  std::string_view text;
};

class Answer : public testing::TestWithParam<asked_for> {};

TEST_P(Answer, IsTheRightOne) {
  bench of(GetParam().word);
  GetParam().set_up(of);
  const auto all = of.run();
  const question_answer found = answer_to(all, GetParam().question);
  EXPECT_EQ(found.question, GetParam().question);
  EXPECT_EQ(name_of(found.state), name_of(GetParam().state)) << all_of(all);
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

constexpr std::string_view by_level = "The level: it turns whenever the line is high.";
constexpr std::string_view by_edge = "An edge; that of an opened port is enough.";
constexpr std::string_view by_pulse = "An edge, while the port is open:";
const port_info cp2102 = [] {
  port_info made;
  made.path = "/dev/ttyUSB0";
  made.product = "CP2102";
  made.vendor_id = 0x10C4;
  made.product_id = 0xEA60;
  return made;
}();

const std::vector<asked_for> cases{
    {"X4ByTheLevel", "x4", dtr_by(sim::dtr_start::level), q::dtr_start, answered, by_level},
    {"X4ByAnEdge", "x4", dtr_by(sim::dtr_start::edge), q::dtr_start, answered, by_edge},
    {"X4ByAPulse", "x4", dtr_by(sim::dtr_start::pulse), q::dtr_start, answered, by_pulse},
    {"S4bByTheLevel", "s4b", dtr_by(sim::dtr_start::level), q::dtr_start, answered, by_level},
    {"S4bByAPulse", "s4b", dtr_by(sim::dtr_start::pulse), q::dtr_start, answered, by_pulse},
    {"X2ByTheLevel", "x2", dtr_by(sim::dtr_start::level), q::dtr_start, answered, by_level},
    {"X2ByAnEdge", "x2", dtr_by(sim::dtr_start::edge), q::dtr_start, answered, by_edge},
    {"X4WithoutPower", "x4", [](bench& of) { of.options.motor_has_power = false; }, q::dtr_start,
     not_decided, "No packet came after an edge"},
    {"TheLevelOfASupply", "x4",
     [](bench& of) {
       of.options.dtr_starts_by = sim::dtr_start::level;
       of.options.dtr_cuts = sim::dtr_cut::supply;
     },
     q::dtr_start, answered, by_level},
    {"X4Motor", "x4", dtr_cuts(sim::dtr_cut::motor), q::dtr_cut, answered, "The motor"},
    {"X4Supply", "x4", dtr_cuts(sim::dtr_cut::supply), q::dtr_cut, answered, "The supply"},
    {"X2Motor", "x2", dtr_cuts(sim::dtr_cut::motor), q::dtr_cut, answered, "The motor"},
    {"X2Supply", "x2", dtr_cuts(sim::dtr_cut::supply), q::dtr_cut, answered, "The supply"},
    {"X2MotorWithoutAnUnplug", "x2", [](bench& of) { of.declines = true; }, q::dtr_cut, not_decided,
     "It sent no boot message"},
    {"SettingsAreKept", "g4", [](bench& of) { of.options.settings_outlive_power = true; },
     q::kept_settings, answered, "The scan frequency does."},
    {"SettingsAreLost", "t-mini-pro", [](bench&) {}, q::kept_settings, answered,
     "The scan frequency does not."},
    {"AnotherLidarCameBack", "g4",
     [](bench& of) {
       of.returns_as = of.options;
       of.returns_as->info.serial_digits[0] = '3';
     },
     q::kept_settings, not_decided, "another lidar"},
    {"NoUnplug", "g4", [](bench& of) { of.declines = true; }, q::kept_settings, not_decided,
     "The user declined."},
    {"TheOffsetIsToBeAdded", "tg30", zero_at(3000, 0.0), q::zero_direction, answered,
     "is to be added"},
    {"TheOffsetIsApplied", "tg30", zero_at(3000, -30.0), q::zero_direction, answered,
     "is already applied"},
    {"TheOffsetIsToBeSubtracted", "tg30", zero_at(3000, -60.0), q::zero_direction, answered,
     "is to be subtracted"},
    {"TheOffsetDoesNotFit", "tg30", zero_at(3000, 45.0), q::zero_direction, not_decided,
     "does not fit clearly"},
    {"TheOffset", "g2", zero_at(3000, 0.0), q::zero_offset, answered, "120, in 1/4 degree"},
    {"AHealthError", "g4", [](bench& of) { of.options.condition = {health_status::error, 0x0203}; },
     q::health_codes, answered, "status 2 with code 0203"},
    {"ABridge", "g4", [](bench& of) { of.port = &cp2102; }, q::bridge_and_baud, answered,
     "10c4:ea60 sets 230400 of 230400 baud."},
    {"AShortStream", "g4", [](bench& of) { of.stream_time = std::chrono::milliseconds(300); },
     q::time_packets, not_decided, "less than 10 s"},
    {"TimePackets", "g4",
     [](bench& of) {
       of.options.time_packet_ns = 100'000'000;
       of.stream_time = std::chrono::milliseconds(900);
     },
     q::time_packets, answered, "There are."},
    {"TooFewReturns", "x4", [](bench& of) { of.stream_time = std::chrono::milliseconds(150); },
     q::lower_bits, not_decided, "not clear"},
    {"OneWayInsteadOfTwoWay", "g4", [](bench& of) { of.options = bench("x2").options; },
     q::optional_queries, not_decided, "is not answered"},
    {"ItWasScanning", "x4-pro",
     [](bench& of) {
       of.options = bench("x4").options;
       of.options.dtr_starts_by = sim::dtr_start::level;
       of.scans = true;
     },
     q::unasked_bytes, not_decided, "obeys a stop"},
    {"TheUnitIsTwiceAsLarge", "x4",
     [](bench& of) {
       of.options.scanner.format.code.units_per_mm *= 2;
       of.options.scanner.max_range_mm = 5'000.0;
     },
     q::range_unit, answered, "ranges are 2.00 of what"},
};

INSTANTIATE_TEST_SUITE_P(Question, Answer, testing::ValuesIn(cases),
                         [](const auto& of) { return std::string(of.param.name); });

TEST(Questions, AreInTheOrderOfTheirNumbers) {
  ASSERT_EQ(open_questions().size(), acceptance_question_count);
  for (std::size_t i = 0; i < acceptance_question_count; ++i) {
    EXPECT_EQ(open_questions()[i].which, static_cast<q>(i));
  }
}

TEST(Questions, WithoutResults_NoneIsDecided) {
  for (const question_answer& each : answers_of({})) {
    EXPECT_EQ(each.state, not_decided);
    EXPECT_EQ(each.text, "The step was not done.");
  }
}

}  // namespace
}  // namespace g4lidar::test
