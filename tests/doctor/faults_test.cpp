// SPDX-License-Identifier: MIT
// Every fault of the simulated device gets its own diagnosis, whatever the seed.
#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "doctor/doctor_bench.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;

struct expectation {
  std::string_view name;
  std::vector<std::string_view> faults;
  std::string_view diagnoses;
  int code;
  bool stands = true;  // the motor, at the end
};

void PrintTo(const expectation& one, std::ostream* out) { *out << one.name; }

class Fault : public ::testing::TestWithParam<expectation> {};

std::vector<sim::fault> faults_of_case(const expectation& one) {
  std::vector<sim::fault> faults;
  for (const std::string_view text : one.faults) {
    const auto read = sim::parse_fault(text);
    EXPECT_TRUE(std::holds_alternative<sim::fault>(read)) << text;
    if (const auto* f = std::get_if<sim::fault>(&read)) faults.push_back(*f);
  }
  return faults;
}

TEST_P(Fault, GetsItsOwnDiagnosis) {
  const expectation& expected = GetParam();
  const std::vector<sim::fault> faults = faults_of_case(expected);
  const auto seeds = static_cast<std::uint64_t>(scaled(6));
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    sim::device_options options;
    options.scanner.seed = seed;
    const examined done = examine(options, faults);
    ASSERT_EQ(done.diagnoses(), expected.diagnoses) << "seed " << seed << done;
    ASSERT_EQ(done.code(), expected.code) << done;
    ASSERT_EQ(!done.motor_turns, expected.stands) << done;
    ASSERT_EQ(done.stages.size(), g4_dump::stage_count - 3) << done;
  }
}

const std::vector<expectation> expectations{
    {"flip", {"flip"}, "bits_flipped", 8},
    {"flip_often", {"flip*0.01"}, "bits_flipped", 8},
    {"drop", {"drop"}, "bytes_dropped", 8},
    {"drop_often", {"drop*0.01"}, "bytes_dropped", 8},
    {"insert", {"insert"}, "bytes_inserted", 8},
    {"insert_often", {"insert*0.01"}, "bytes_inserted", 8},
    {"burst", {"burst"}, "bursts", 8},
    {"burst_short", {"burst=4"}, "bursts", 8},
    {"burst_long", {"burst=100"}, "bursts", 8},
    {"truncate", {"truncate"}, "packets_truncated", 8},
    {"truncate_often", {"truncate*0.1"}, "packets_truncated", 8},
    {"stall", {"stall@4s+1s"}, "stalls", 9},
    {"stall_short", {"stall@4s+200ms"}, "stalls", 9},
    {"stall_while_asked", {"stall@1s+2s"}, "stalls", 9},
    {"stall_for_ever", {"stall@4s"}, "stalls", 9},
    {"stall_from_the_begin", {"stall"}, "silent", 6},
    {"batch", {"batch"}, "usb_latency", 0},
    {"batch_short", {"batch=8ms"}, "usb_latency", 0},
    {"late", {"late"}, "answers_late", 8},
    {"late_by_a_second", {"late=1s"}, "answers_late", 8},
    {"late_by_four_seconds", {"late=4s"}, "answers_late", 8},
    {"late_at_times", {"late*0.3"}, "answers_late", 8},
    {"wrong", {"wrong"}, "answers_wrong", 8},
    {"wrong_at_times", {"wrong*0.3"}, "answers_wrong", 8},
    {"twice", {"twice"}, "answers_twice", 0},
    {"twice_at_times", {"twice*0.3"}, "answers_twice", 0},
    {"mute", {"mute"}, "answers_missing", 8},
    {"mute_at_times", {"mute*0.3"}, "answers_missing", 8},
    {"deaf_and_scanning", {"deaf", "scanning"}, "was_scanning deaf", 8, false},
    {"deaf_later", {"deaf@3s"}, "deaf", 8, false},
    {"deaf_and_idle", {"deaf"}, "silent", 6},
    {"baud_and_scanning", {"baud", "scanning"}, "wrong_baud_rate", 6, false},
    {"baud_later", {"baud@4s"}, "wrong_baud_rate", 6, false},
    {"baud_and_idle", {"baud"}, "silent", 6},
    {"scanning", {"scanning"}, "was_scanning", 0},
    {"scanning_later", {"scanning@500ms"}, "was_scanning", 0},
    {"brown_out", {"brown_out"}, "brown_out", 8},
    {"brown_out_later", {"brown_out=500ms"}, "brown_out", 8},
    {"reboot", {"reboot"}, "reboots", 8},
    {"reboot_later", {"reboot=3s"}, "reboots", 8},
    {"unplug", {"unplug@500ms+1s"}, "unplugged", 9},
    {"unplug_while_scanning", {"unplug@4s"}, "unplugged", 9},
    {"health_warning", {"health=warning"}, "health_warning", 0},
    {"health_error", {"health=error"}, "health_error", 8},
    {"jolt", {"jolt"}, "jolts", 0},
    {"batch_and_flip", {"batch", "flip"}, "bits_flipped usb_latency", 8},
    {"scanning_and_drop", {"scanning", "drop"}, "was_scanning bytes_dropped", 8},
    {"twice_and_jolt", {"twice", "jolt"}, "answers_twice jolts", 0},
};

INSTANTIATE_TEST_SUITE_P(All, Fault, ::testing::ValuesIn(expectations),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(Faults, AllKindsAreExpected) {
  std::set<sim::fault_kind> seen;
  for (const expectation& one : expectations) {
    for (const sim::fault& f : faults_of_case(one)) seen.insert(f.kind);
  }
  EXPECT_EQ(seen.size(), static_cast<std::size_t>(sim::fault_kind::jolt) + 1);
}

// A device that is silent from the begin may be one of several things: the diagnosis names them.
TEST(Faults, SilenceNamesWhatElseItMayBe) {
  std::set<g4_dump::diagnosis> others;
  for (const auto each : g4_dump::words_of(g4_dump::diagnosis::silent).or_else) others.insert(each);
  EXPECT_TRUE(others.contains(g4_dump::diagnosis::deaf));
  EXPECT_TRUE(others.contains(g4_dump::diagnosis::wrong_baud_rate));
  EXPECT_TRUE(others.contains(g4_dump::diagnosis::stalls));
}

// The damage is told whatever the packets are like.
TEST(Faults, DamageIsToldAtOtherRatesAndSizes) {
  const std::vector<std::pair<std::string_view, std::string_view>> kinds{
      {"flip", "bits_flipped"},
      {"drop", "bytes_dropped"},
      {"insert", "bytes_inserted"},
      {"burst*0.0003", "bursts"},
      {"truncate*0.05", "packets_truncated"},
      {"jolt*0.05", "jolts"},
      {"batch", "usb_latency"}};
  for (const ranging_frequency rate :
       {ranging_frequency::khz_4, ranging_frequency::khz_8, ranging_frequency::khz_9}) {
    for (const std::size_t samples : {24U, 40U, 80U}) {
      for (const auto& [fault, diagnosis] : kinds) {
        sim::device_options options;
        options.scanner.ranging = rate;
        options.scanner.samples_per_packet = samples;
        options.scanner.seed = samples + static_cast<std::uint64_t>(rate);
        const examined done = examine(options, faults_of({fault}));
        ASSERT_EQ(done.diagnoses(), diagnosis) << samples << " samples" << done;
      }
    }
  }
}

}  // namespace
