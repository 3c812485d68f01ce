// SPDX-License-Identifier: MIT
// g4-dump decode: whole scans, and the counts at the end.
#include <gtest/gtest.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "program.hpp"
#include "recording.hpp"

namespace {

using cli::lines_of;
using cli::outcome;
using cli::run;
using cli::small_recording;
using nlohmann::json;
using words = std::vector<std::string>;

std::string two_and_a_half_turns() {
  const std::string whole = cli::zero(0, 4000, 71) + cli::turn();
  return whole + whole + cli::zero(0, 0, 71) + cli::turn(18).substr(0, 3 * 90);
}

TEST(Decode, ScansAsCsv) {
  const outcome done = run({"decode", "--scans"}, two_and_a_half_turns());
  EXPECT_EQ(done.out,
            "scan,time_ns,points,returns,partial,why,turned_deg,reported_hz,measured_hz\n"
            "0,0,361,361,false,,360.00,7.1,24.931\n"
            "1,40111111,361,361,false,,360.00,7.1,24.931\n"
            "2,80222222,121,120,true,end_missing,59.50,7.1,\n");
  const outcome small = run({"decode", "--scans", "--valid"}, small_recording());
  EXPECT_TRUE(lines_of(small.out).at(2).starts_with("1,444444,3,3,true,data_lost+turn_short,"));
}

TEST(Decode, ScansAsText) {
  const outcome done = run({"decode", "--scans", "--format", "text"}, two_and_a_half_turns());
  EXPECT_EQ(
      done.out,
      "  scan  points  returns  turned_deg  reported_hz  measured_hz  state\n"
      "     0     361      361      360.00          7.1        24.93  whole\n"
      "     1     361      361      360.00          7.1        24.93  whole\n"
      "     2     121      120       59.50          7.1            -  partial: end_missing\n");
}

void expect_turns_as_jsonl(const outcome& done) {
  const std::vector<std::string> lines = lines_of(done.out);
  ASSERT_EQ(lines.size(), 3U);
  const json first = json::parse(lines[0]);
  EXPECT_EQ(first.at("scan"), 0);
  EXPECT_EQ(first.at("partial"), false);
  EXPECT_EQ(first.at("why"), json::array());
  EXPECT_EQ(first.at("points"), 361);
  EXPECT_EQ(first.at("reported_hz"), 7.1);
  EXPECT_NEAR(first.at("measured_hz").get<double>(), 9000.0 / 361.0, 1e-3);
  for (const char* const column : {"angle_deg", "range_mm", "time_ns"}) {
    EXPECT_EQ(first.at(column).size(), 361U) << column;
  }
  EXPECT_EQ(first.at("time_ns").at(360), 40'000'000);
  const json last = json::parse(lines[2]);
  EXPECT_EQ(last.at("partial"), true);
  EXPECT_EQ(last.at("why"), json::array({"end_missing"}));
  EXPECT_EQ(last.at("range_mm").at(0), 0.0);
  EXPECT_TRUE(last.at("measured_hz").is_null());
}

TEST(Decode, ScansAsJsonl) {
  const std::string turns = two_and_a_half_turns();
  expect_turns_as_jsonl(run({"decode", "--scans", "--format", "jsonl"}, turns));
  expect_turns_as_jsonl(run({"scan", "-", "--partial", "-f", "jsonl"}, turns));
  const outcome valid =
      run({"decode", "--scans", "--valid", "--format", "jsonl"}, two_and_a_half_turns());
  const json last_valid = json::parse(lines_of(valid.out).at(2));
  EXPECT_EQ(last_valid.at("points"), 120);
  EXPECT_EQ(last_valid.at("angle_deg").size(), 120U);
}

TEST(Decode, StoppedMotor_FillsNoMemoryAndLosesNoPoint) {
  std::string recording;
  for (int i = 0; i < 1000; ++i)
    recording += cli::packet(10, 10, std::vector<std::uint16_t>(40, 4000));
  std::uint64_t points = 0;
  const outcome done = run({"decode", "--scans", "--format", "jsonl"}, recording);
  for (const std::string& line : lines_of(done.out)) {
    points += json::parse(line).at("points").get<std::uint64_t>();
  }
  EXPECT_EQ(points, 40'000U);
}

TEST(Decode, StatsAsJson_OneObjectAndNothingElse) {
  // 5 bytes of noise; a header that cannot be; a packet with a wrong checksum; one cut off.
  const std::string recording = "noise" + std::string("\xAA\x55\x00\xFF", 4) + small_recording() +
                                cli::zero(0) + cli::damaged(cli::packet(1, 2, {4000, 4000}), 11) +
                                cli::zero(0) + cli::packet(1, 2, {4000}).substr(0, 11);
  const outcome done = run({"decode", "--stats", "json"}, recording);
  EXPECT_EQ(done.code, 0);
  const std::size_t cut_off =
      12;  // of small_recording(): a packet follows, so it is a bad checksum
  nlohmann::ordered_json expected;
  expected["bytes"] = recording.size();
  expected["packets"] = 7;
  expected["responses"] = 1;
  expected["points"] = 11;
  expected["suspect"] = 1;
  expected["time_packets"] = 0;
  expected["empty_packets"] = 0;
  expected["crc_matches"] = 0;
  expected["crc_mismatches"] = 0;
  expected["skipped"]["noise"] = 6;
  expected["skipped"]["bad_header"] = 4;
  expected["skipped"]["bad_checksum"] = cut_off + 14;
  expected["skipped"]["truncated"] = 11;
  EXPECT_EQ(done.err, expected.dump() + "\n");
}

TEST(Decode, StatsAsText) {
  for (const words& each : {words{"decode"}, {"dump", "-"}}) {
    EXPECT_EQ(run(each, small_recording()).err,
              "read as G4: 2-byte samples do not name their model; --model names another one: f4, "
              "g2a, g6, x4, x2, x3-pro, tg15, tx8\n"
              "92 bytes: 5 packets (1 suspect) with 9 points, 1 response\n"
              "13 bytes skipped: 1 noise, 0 bad header, 0 bad checksum, 12 truncated\n");
  }
  EXPECT_EQ(run({"dump", "-", "-q"}, small_recording()).err, "");
}

TEST(Decode, InputOfMostlyNoise_GivesARemark) {
  const std::string noise(1000, 'x');
  const outcome output = run({"decode"}, noise + cli::zero(0));
  EXPECT_EQ(output.code, 0);
  EXPECT_NE(output.err.find("wrong baud rate"), std::string::npos);
  EXPECT_EQ(run({"decode"}, noise + cli::turn() + cli::turn()).err.find("baud"), std::string::npos);
  const outcome as_json = run({"decode", "--stats", "json"}, noise + cli::zero(0));
  EXPECT_EQ(json::parse(as_json.err).at("skipped").at("noise"), 1000);
}

}  // namespace
