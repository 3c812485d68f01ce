// SPDX-License-Identifier: MIT
#include "g4lidar/diagnostics/diagnosis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "support/cdr_reader.hpp"

namespace g4lidar::test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Pair;

TEST(DiagnosticArray, IsReadByTheRulesOfCdr) {
  const std::vector<diagnostic_status> statuses{
      {diagnostic_level::warn,
       "g4lidar: rate",
       "slow",
       "2021",
       {{"measured_hz", "6.9"}, {"a", ""}}},
      {.level = diagnostic_level::stale, .name = "g4lidar: loss"}};
  std::vector<std::uint8_t> message;
  put_diagnostic_array(statuses, 3'000'000'004, message);
  cdr_reader read(message);
  EXPECT_EQ(read.number<std::int32_t>(), 3);
  EXPECT_EQ(read.number<std::uint32_t>(), 4U);
  EXPECT_EQ(read.text(), "");
  EXPECT_EQ(read.number<std::uint32_t>(), 2U);
  EXPECT_EQ(read.number<std::uint8_t>(), 1);
  for (const char* text : {"g4lidar: rate", "slow", "2021"}) EXPECT_EQ(read.text(), text);
  EXPECT_EQ(read.number<std::uint32_t>(), 2U);
  for (const char* text : {"measured_hz", "6.9", "a", ""}) EXPECT_EQ(read.text(), text);
  EXPECT_EQ(read.number<std::uint8_t>(), 3);
  for (const char* text : {"g4lidar: loss", "", ""}) EXPECT_EQ(read.text(), text);
  EXPECT_EQ(read.number<std::uint32_t>(), 0U);
  EXPECT_TRUE(read.is_at_end());
}

TEST(DiagnosticStatus, OfAStage_HasItsCauseAdviceAndEvidence) {
  stage_report stage{.stage = diagnostic_stage::loss};
  stage.add("lost_percent", 1.25);
  EXPECT_EQ(status_of(stage, "7").message, "ok");
  EXPECT_EQ(status_of(stage, "7").level, diagnostic_level::ok);
  stage.find(diagnosis::bits_flipped);
  stage.remark = "This is little evidence: measure longer.";
  const diagnostic_status made = status_of(stage, "2021101000070073");
  EXPECT_EQ(made.level, diagnostic_level::error);
  EXPECT_EQ(made.name, "g4lidar: loss");
  EXPECT_EQ(made.hardware_id, "2021101000070073");
  EXPECT_EQ(
      made.message,
      "Packets of the right length contain single wrong bits: the line is disturbed. "
      "Use a shorter or better cable between lidar and bridge, keep it away from motors, press "
      "the plugs in, and check that lidar and host share a good ground. "
      "This is little evidence: measure longer.");
  EXPECT_THAT(made.values, Contains(Pair("diagnosis", "bits_flipped")));
  EXPECT_THAT(made.values, Contains(Pair("lost_percent", "1.25")));
  stage_report warned{.stage = diagnostic_stage::stream};
  warned.find(diagnosis::jolts);
  EXPECT_EQ(status_of(warned, "").level, diagnostic_level::warn);
}

TEST(DiagnosticStatus, OfAStageThatWasSkipped_HasTheReason) {
  stage_report stage{.stage = diagnostic_stage::rate, .outcome = stage_verdict::skipped};
  stage.remark = "No scan is running.";
  EXPECT_EQ(status_of(stage, "").message, "No scan is running.");
  EXPECT_EQ(status_of(stage, "").level, diagnostic_level::ok);
}

TEST(DiagnosticStatus, OfAReader_IsAWarningWhereSomethingContradictsTheModel) {
  reader_status now{
      .state = reader_state::running, .recognised = {{"model", "x4"}}, .name = "/dev/x"};
  EXPECT_EQ(status_of(now, "").level, diagnostic_level::ok);
  EXPECT_EQ(status_of(now, "").message, "running");
  EXPECT_THAT(status_of(now, "").values,
              ElementsAre(Pair("device", "/dev/x"), Pair("model", "x4")));
  now.recognised.push_back({"contradictions", "It is green."});
  EXPECT_EQ(status_of(now, "").level, diagnostic_level::warn);
  EXPECT_EQ(status_of(now, "").message, "running. It is green.");
  for (const auto state : {reader_state::opening, reader_state::lost, reader_state::ended}) {
    now.state = state;
    EXPECT_EQ(status_of(now, "It is gone.").level, diagnostic_level::error);
    EXPECT_EQ(status_of(now, "It is gone.").message, std::string(name_of(state)) + ": It is gone.");
  }
  now.recognised.clear();
  EXPECT_EQ(status_of(now, "").level, diagnostic_level::ok) << "the end of a file";
}

TEST(DiagnosticStatus, OfCounts_HasAllOfThem) {
  lidar_counts counts;
  counts.bytes = 1;
  counts.scans = 12;
  counts.stream.skipped_by_reason[static_cast<std::size_t>(skip_reason::bad_checksum)] = 90;
  const auto all = statuses_of(std::vector<stage_report>(2), counts, "7");
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[2].name, "g4lidar: counts");
  EXPECT_EQ(all[2].hardware_id, "7");
  EXPECT_THAT(all[2].values, Contains(Pair("scans", "12")));
  EXPECT_THAT(all[2].values, Contains(Pair("skipped_bad_checksum_bytes", "90")));
}

TEST(DiagnosticArray, HasItsSchema) {
  EXPECT_EQ(diagnostic_array_schema().name, "diagnostic_msgs/msg/DiagnosticArray");
}

}  // namespace
}  // namespace g4lidar::test
