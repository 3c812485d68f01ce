// SPDX-License-Identifier: MIT
// Every fault of the simulated device gets its own diagnosis, with every seed.
#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "diagnostics/doctor_bench.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;

struct expectation {
  std::string_view name;
  std::vector<std::string_view> faults;
  std::string_view diagnoses;
  bool fails;
  bool stands = true;     // the motor is stopped at the end
  bool is_named = false;  // the model, by the user
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
  for (const int each : test::seeds(6)) {
    const auto seed = static_cast<std::uint64_t>(each);
    sim::device_options options;
    options.scanner.seed = seed;
    const examined done =
        examine(options, faults, {.model = expected.is_named ? &g4_model : nullptr});
    ASSERT_EQ(done.diagnoses(), expected.diagnoses) << "seed " << seed << done;
    ASSERT_EQ(done.fails(), expected.fails) << done;
    ASSERT_EQ(!done.motor_turns, expected.stands) << done;
    ASSERT_EQ(done.stages.size(), diagnostic_stage_count - 3) << done;
    ASSERT_LE(done.seconds, 45.0 + 5.0) << done;  // as documented, and the measurement
  }
}

const std::vector<expectation> expectations{
    {"flip", {"flip"}, "bits_flipped", true},
    {"flip_often", {"flip*0.01"}, "bits_flipped", true},
    {"drop", {"drop"}, "bytes_dropped", true},
    {"drop_often", {"drop*0.01"}, "bytes_dropped", true},
    {"insert", {"insert"}, "bytes_inserted", true},
    {"insert_often", {"insert*0.01"}, "bytes_inserted", true},
    {"burst", {"burst"}, "bursts", true},
    {"burst_short", {"burst=4"}, "bursts", true},
    {"burst_long", {"burst=100"}, "bursts", true},
    {"truncate", {"truncate"}, "packets_truncated", true},
    {"truncate_often", {"truncate*0.1"}, "packets_truncated", true},
    {"stall", {"stall@4s+1s"}, "stalls", true},
    {"stall_short", {"stall@4s+200ms"}, "stalls", true},
    {"stall_while_asked", {"stall@1s+2s"}, "stalls", true},
    {"stall_for_ever", {"stall@4s"}, "stalls", true},
    {"stall_from_the_begin", {"stall"}, "silent", true},
    {"batch", {"batch"}, "usb_latency", false},
    {"batch_short", {"batch=8ms"}, "usb_latency", false},
    {"late", {"late"}, "answers_late", true},
    {"late_by_a_second", {"late=1s"}, "answers_late", true},
    {"late_by_four_seconds", {"late=4s"}, "answers_late", true},
    {"late_at_times", {"late*0.3"}, "answers_late", true},
    {"wrong", {"wrong"}, "answers_wrong", true},
    {"wrong_at_times", {"wrong*0.3"}, "answers_wrong", true},
    {"twice", {"twice"}, "answers_twice", false},
    {"twice_at_times", {"twice*0.3"}, "answers_twice", false},
    {"mute", {"mute"}, "silent", true},
    {"mute_and_named", {"mute"}, "answers_missing", true, true, true},
    {"mute_at_times", {"mute*0.3"}, "answers_missing", true},
    {"deaf_and_scanning", {"deaf", "scanning"}, "deaf", true, false},
    {"deaf_later", {"deaf@3s"}, "deaf", true, false},
    {"deaf_and_idle", {"deaf"}, "silent", true},
    {"baud_and_scanning", {"baud", "scanning"}, "unknown_bytes", true, false},
    {"baud_later", {"baud@4s"}, "wrong_baud_rate", true, false},
    {"baud_and_idle", {"baud"}, "silent", true},
    {"scanning", {"scanning"}, "was_scanning", false},
    {"scanning_later", {"scanning@500ms"}, "was_scanning", false},
    {"brown_out", {"brown_out"}, "brown_out", true},
    {"brown_out_later", {"brown_out=500ms"}, "brown_out", true},
    {"reboot", {"reboot"}, "reboots", true},
    {"reboot_later", {"reboot=3s"}, "reboots", true},
    {"unplug", {"unplug@500ms+1s"}, "unplugged", true},
    {"unplug_while_scanning", {"unplug@4s"}, "unplugged", true},
    {"health_warning", {"health=warning"}, "health_warning", false},
    {"health_error", {"health=error"}, "health_error", true},
    {"jolt", {"jolt"}, "jolts", false},
    {"omit", {"omit"}, "packets_lost", true},
    {"batch_and_flip", {"batch", "flip"}, "bits_flipped usb_latency", true},
    {"scanning_and_drop", {"scanning", "drop"}, "was_scanning bytes_dropped", true},
    {"twice_and_jolt", {"twice", "jolt"}, "answers_twice jolts", false},
};

}  // namespace

std::string g4lidar::test::diagnoses_of_faults() {
  std::string all;
  for (const expectation& one : expectations) all.append(one.diagnoses).append(" ");
  return all;
}

namespace {

INSTANTIATE_TEST_SUITE_P(All, Fault, ::testing::ValuesIn(expectations),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(Faults, AllKindsAreExpected) {
  std::set<sim::fault_kind> seen;
  for (const expectation& one : expectations) {
    for (const sim::fault& f : faults_of_case(one)) seen.insert(f.kind);
  }
  EXPECT_EQ(seen.size(), static_cast<std::size_t>(sim::last_fault_kind) + 1);
}

// So much noise that hardly a packet is left: neither the motor nor the baud rate is at fault, and it is not silent.
TEST(Faults, AVeryNoisyLine_IsNothingElse) {
  // With the number of a model that has other samples, too.
  const std::vector<std::pair<const char*, int>> devices{
      {"g4", 0}, {"x4", 0}, {"t-mini-plus", 0}, {"t-mini-plus-sh", 151}, {"g4", 150}};
  for (const std::string_view fault :
       {"flip*0.05@1s", "drop*0.04@1s", "flip*0.2@1s", "insert*0.05@1s", "flip*0.1", "flip*0.03"}) {
    for (const auto& [word, number] : devices) {
      sim::device_options options;
      ASSERT_TRUE(sim::use_model(options, word));
      if (number != 0) options.info.model = static_cast<std::uint8_t>(number);
      const examined done = examine(options, faults_of({fault}));
      for (const auto* const wrong : {"motor_stuck", "motor_unsteady", "wrong_baud_rate", "silent",
                                      "brown_out", "does_not_start", "frequency_off"}) {
        EXPECT_EQ(done.diagnoses().find(wrong), std::string::npos) << word << fault << done;
      }
      EXPECT_NE(done.diagnoses(), "") << word << fault << done;
    }
  }
}

// A device that is silent from the begin may have one of several faults: the diagnosis names them.
TEST(Faults, Silence_NamesTheAlternatives) {
  std::set<diagnosis> others;
  for (const auto each : describe(diagnosis::silent).alternatives) others.insert(each);
  EXPECT_TRUE(others.contains(diagnosis::deaf));
  EXPECT_TRUE(others.contains(diagnosis::wrong_baud_rate));
  EXPECT_TRUE(others.contains(diagnosis::stalls));
}

// The damage is diagnosed for all kinds of packets.
TEST(Faults, Damage_IsFoundAtOtherRatesAndSizes) {
  const std::vector<std::pair<std::string_view, std::string_view>> kinds{
      {"flip", "bits_flipped"},
      {"drop", "bytes_dropped"},
      {"insert", "bytes_inserted"},
      {"burst*0.0003", "bursts"},
      {"truncate*0.05", "packets_truncated"},
      {"jolt*0.05", "jolts"},
      {"batch", "usb_latency"}};
  for (const sample_rate rate : {sample_rate::khz_4, sample_rate::khz_8, sample_rate::khz_9}) {
    for (const std::size_t samples : {24U, 40U, 80U}) {
      for (const auto& [fault, diagnosis] : kinds) {
        sim::device_options options;
        options.scanner.sample_rate = rate;
        options.scanner.samples_per_packet = samples;
        options.scanner.seed = samples + static_cast<std::uint64_t>(rate);
        const examined done = examine(options, faults_of({fault}));
        ASSERT_EQ(done.diagnoses(), diagnosis) << samples << " samples" << done;
      }
    }
  }
}

}  // namespace
