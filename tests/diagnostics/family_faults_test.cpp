// SPDX-License-Identifier: MIT
// The faults of a G4 with lidars of other models: two-way ones, ones that DTR drives, one-way ones.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "diagnostics/doctor_bench.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/sim/device_options.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;

struct expectation {
  std::string_view name;
  std::vector<std::string_view> faults;
  std::string_view answering;  ///< The diagnoses of a two-way lidar.
  std::string_view one_way;    ///< The same of a one-way lidar; "-": the fault needs answers.
};

void PrintTo(const expectation& one, std::ostream* out) { *out << one.name; }

class FamilyFault : public ::testing::TestWithParam<expectation> {};

TEST_P(FamilyFault, GetsItsOwnDiagnosis) {
  const expectation& expected = GetParam();
  const std::vector<std::string_view> words{"x4", "t-mini-pro", "g2",     "tg30",
                                            "g6", "s4b",        "x4-pro", "x2"};
  for (const std::string_view word : words) {
    for (const int seed : test::seeds(2)) {
      sim::device_options options;
      ASSERT_TRUE(sim::use_model(options, word));
      options.scanner.seed = static_cast<std::uint64_t>(seed);
      const std::string_view wanted = options.one_way ? expected.one_way : expected.answering;
      if (wanted == "-") continue;
      diagnostic_options how;
      how.model = model_named(word);
      std::vector<sim::fault> faults;
      for (const std::string_view text : expected.faults) {
        for (const sim::fault& each : faults_of({text})) faults.push_back(each);
      }
      const examined done = [&] {
        sim::device simulated(sim::built_in_world(), options, faults);
        sim::virtual_clock clock;
        return examine(simulated, clock, how);
      }();
      EXPECT_EQ(done.diagnoses(), wanted) << word << " seed " << seed << done;
      EXPECT_EQ(done.stages.size(), diagnostic_stage_count - 3) << done;
      EXPECT_LE(done.seconds, 45.0 + 5.0) << done;
    }
  }
}

const std::vector<expectation> expectations{
    {"flip_often", {"flip*0.003"}, "bits_flipped", "bits_flipped"},
    {"burst", {"burst"}, "bursts", "bursts"},
    {"stall", {"stall@4500ms+1s"}, "stalls", "stalls"},
    {"stall_for_ever", {"stall@4500ms"}, "stalls", "stalls"},
    {"stall_from_the_begin", {"stall"}, "silent", "silent"},
    {"late", {"late"}, "answers_late", "-"},
    {"wrong", {"wrong"}, "answers_wrong", "-"},
    {"twice", {"twice"}, "answers_twice", "-"},
    {"mute", {"mute"}, "answers_missing", "-"},
    {"mute_at_times", {"mute*0.3"}, "answers_missing", "-"},
    {"deaf_and_idle", {"deaf"}, "silent", "-"},
    {"baud_later", {"baud@5s"}, "wrong_baud_rate", "wrong_baud_rate"},
    {"scanning", {"scanning"}, "was_scanning", "-"},
    {"unplug", {"unplug@500ms+1s"}, "unplugged", "unplugged"},
    {"unplug_while_scanning", {"unplug@4500ms"}, "unplugged", "unplugged"},
    {"health_warning", {"health=warning"}, "health_warning", "-"},
    {"health_error", {"health=error"}, "health_error", "-"},
    {"jolt", {"jolt"}, "jolts", "jolts"},
    {"batch", {"batch=24ms"}, "usb_latency", "usb_latency"},
    {"reboot", {"reboot"}, "reboots", "-"},
    {"brown_out", {"brown_out"}, "brown_out", "-"},
};

INSTANTIATE_TEST_SUITE_P(All, FamilyFault, ::testing::ValuesIn(expectations),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(FamilyZeroAngle, WithoutAnAnswerTo93_IsAWarning) {
  for (const std::string_view word : {"g1", "g2", "g2a", "g2c", "r2", "tg15", "tg30", "tg50"}) {
    for (const std::string_view text : {"mute=93", "mute=91"}) {
      sim::device_options options;
      ASSERT_TRUE(sim::use_model(options, word));
      diagnostic_options how;
      how.model = model_named(word);
      sim::device simulated(sim::built_in_world(), options, faults_of({text}));
      sim::virtual_clock clock;
      const examined done = examine(simulated, clock, how);
      EXPECT_EQ(done.diagnoses(), text == "mute=93" ? "no_zero_angle" : "") << word << done;
    }
  }
}

}  // namespace
