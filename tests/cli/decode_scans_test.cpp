// SPDX-License-Identifier: MIT
// g4-dump decode: whole scans, and the counts at the end.
#include <gtest/gtest.h>

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
