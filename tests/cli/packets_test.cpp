// SPDX-License-Identifier: MIT
// g4-dump packets: what goes over the line, in words; each byte in one line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <string>
#include <vector>

#include "program.hpp"
#include "recording.hpp"

namespace {

using cli::lines_of;
using cli::outcome;
using cli::run;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string with_everything() {
  return "noise" + cli::scan_started() + cli::zero(0, 1120, 70) +
         cli::packet(1, 10, {4000, 0, 300}) + cli::packet(20, 19, {4000, 4000}) +
         cli::damaged(cli::packet(30, 40, {4000, 4000}), 11) + cli::zero(359) +
         cli::packet(1, 2, {8000, 8000}).substr(0, 12);
}

TEST(Packets, OfRawBytes) {
  const outcome done = run({"packets", "-"}, with_everything());
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(
      done.out,
      "       0 ! skipped 5 bytes: noise  6E 6F 69 73 65\n"
      "       5 < scan started\n"
      "      12 < packet   0.00 to   0.00 deg,  1 sample, checksum ok, zero packet, 7.0 Hz\n"
      "      24 < packet   1.00 to  10.00 deg,  3 samples, checksum ok\n"
      "      40 ! packet  20.00 to  19.00 deg,  2 samples, checksum ok, suspect: its angles go "
      "back  AA 55 00 02 01 0A 81 09 2A 54 A0 0F A0 0F\n"
      "      54 ! skipped 14 bytes: bad checksum  AA 55 00 02 01 0F 01 14 AA 4C A0 0E A0 0F\n"
      "      68 < packet 359.00 to 359.00 deg,  1 sample, checksum ok, zero packet\n"
      "      80 ! skipped 12 bytes: truncated  AA 55 00 02 81 00 01 01 2A 56 40 1F\n");
  EXPECT_THAT(done.err, HasSubstr("92 bytes: 4 packets (1 suspect) with 5 points, 1 response\n"));
}

TEST(Packets, BothDirectionsOfALidar) {
  const outcome done = run({"packets", "sim:?seed=4", "-d", "400ms", "--time", "zero"});
  EXPECT_EQ(done.code, 0) << done.err;
  const std::vector<std::string> lines = lines_of(done.out);
  EXPECT_THAT(lines.at(0), StartsWith("0.000000 - opened "));
  std::size_t at = 0;
  for (const char* const what :
       {"> stop  A5 65", "> device information?  A5 90",
        "< device information: model 5 (G4), firmware 3.2, hardware 3, serial 2021101000070073",
        "< health: ok, code 0", "> start  A5 60", "< scan started", "< packet ", "> stop  A5 65",
        "- closed"}) {
    while (at < lines.size() && lines[at].find(what) == std::string::npos) ++at;
    ASSERT_LT(at++, lines.size()) << what << " is not there, or not in its place";
  }
  for (const std::string& line : lines) {
    EXPECT_TRUE(std::regex_search(line, std::regex(R"(^\d+\.\d{6} [-<>!] )"))) << line;
  }
}

TEST(Packets, BytesBeforeAFailure_AreWritten) {
  const outcome done = run({"packets", "sim:?fault=mute@0"});
  EXPECT_EQ(done.code, 6);
  EXPECT_THAT(done.out, HasSubstr("> device information?  A5 90\n"));
  EXPECT_THAT(done.err, StartsWith("g4-dump: "));
}

}  // namespace
