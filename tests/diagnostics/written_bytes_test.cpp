// SPDX-License-Identifier: MIT
// What a diagnostic run writes without a named model, before a lidar has answered.
#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "diagnostics/doctor_bench.hpp"
#include "discovery/search_bench.hpp"

namespace g4lidar::test {
namespace {

constexpr std::int64_t ms = 1'000'000;

struct written {
  examined done;
  std::vector<std::string> notes;
};

written examine_noting(const sim::device_options& options, const std::vector<sim::fault>& faults,
                       const model* named = nullptr) {
  sim::device simulated(sim::built_in_world(), options, faults);
  sim::virtual_clock clock;
  std::shared_ptr<const std::vector<std::string>> notes;
  examined done =
      examine(simulated, clock, {.model = named}, [&notes](std::unique_ptr<transport> inner) {
        auto port = std::make_unique<noting_port>(std::move(inner));
        notes = port->shared_notes();
        return port;
      });
  return {std::move(done), *notes};
}

/// The first two digits: "90" of "90@230400", "dt" of a change of DTR.
std::set<std::string> commands_in(const std::vector<std::string>& notes) {
  std::set<std::string> all;
  for (const std::string& each : notes) all.insert(each.substr(0, 2));
  return all;
}

// The search of 3 s with the pulse of DTR, which is low after it, and three more questions.
TEST(WrittenBytes, SilentPort_GetsTheQuestionForItsIdentityAlone) {
  const written seen = examine_noting({}, faults_of({"deaf"}));
  EXPECT_EQ(seen.done.diagnoses(), "silent") << seen.done;
  const std::vector<std::string> expected{
      "90@230400", "90@128000", "90@115200", "90@153600", "90@512000", "dtr=0",
      "dtr=1",     "90@150000", "90@214285", "90@256000", "90@460800", "90@921600",
      "90@230400", "dtr=0",     "90@230400", "90@230400", "90@230400"};
  EXPECT_EQ(seen.notes, expected);
  EXPECT_NE(seen.done.at(diagnostic_stage::answers).remark.find("No model was named"),
            std::string::npos)
      << seen.done;
}

TEST(WrittenBytes, LidarThatAnswersNothing_IsNotStarted) {
  EXPECT_EQ(commands_in(examine_noting({}, faults_of({"mute"})).notes),
            (std::set<std::string>{"90", "dt"}));
  const written named = examine_noting({}, faults_of({"mute"}), &g4_model);
  EXPECT_TRUE(commands_in(named.notes).contains("60"));
  EXPECT_TRUE(commands_in(named.notes).contains("65"));
}

// Bytes that are no packets: a GPS receiver, a board that boots.
TEST(WrittenBytes, OtherDevices_GetTheQuestionAlone) {
  sim::device_options other;
  other.boots_at_start = true;
  other.boot_ns = 30'000 * ms;
  EXPECT_EQ(commands_in(examine_noting(other, {}).notes), (std::set<std::string>{"90", "dt"}));
  const written garbled = examine_noting({}, faults_of({"baud", "scanning"}));
  for (const std::string& each : commands_in(garbled.notes)) EXPECT_EQ(each, "90");
}

// Its packets alone show that it takes no commands.
TEST(WrittenBytes, OneWayLidarThatIsRecognised_GetsNoByte) {
  for (const std::string_view word : {"x2", "x4-pro", "s2-pro-intensity"}) {
    sim::device_options options;
    ASSERT_TRUE(sim::use_model(options, word));
    std::set<std::string> commands = commands_in(examine_noting(options, {}).notes);
    commands.erase("dt");
    EXPECT_EQ(commands, std::set<std::string>{}) << word;
  }
}

}  // namespace
}  // namespace g4lidar::test
