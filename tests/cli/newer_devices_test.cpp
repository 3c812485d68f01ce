// SPDX-License-Identifier: MIT
// Bytes of devices that send time packets, and a CRC before zero packets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "program.hpp"
#include "recording.hpp"
#include "support/patience.hpp"

namespace {

using cli::lines_of;
using cli::outcome;
using cli::run;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

const std::string clock_1000_ms("\xAA\x66\x27\xE8\x03\0\0\0", 8);

TEST(NewerDevices, TimePacketsArePackets) {
  const std::string bytes = cli::zero(0) + clock_1000_ms + cli::turn() + clock_1000_ms;
  const outcome shown = run({"packets", "-"}, bytes);
  EXPECT_EQ(shown.code, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("time packet: 1000 ms"));
  EXPECT_THAT(shown.out, Not(HasSubstr("noise")));
  EXPECT_THAT(shown.err, HasSubstr("2 time packets"));
  EXPECT_THAT(shown.err, HasSubstr("0 bytes skipped"));
}

// The CT bytes of a revolution are 1 and nine times 0: by another program their CRC-8/MAXIM is CEh.
TEST(NewerDevices, RevolutionWithAWrongCrcIsPartial) {
  const std::string crc = "\xCE";
  const std::string revolution = cli::zero(0) + cli::turn() + crc;
  const std::string lost = cli::zero(0) + cli::turn().substr(90) + crc;
  const std::string bytes = revolution + revolution + revolution + lost + revolution + cli::zero(0);
  const outcome done = run({"decode", "--scans", "--stats", "json"}, bytes);
  EXPECT_THAT(lines_of(done.out).at(4), HasSubstr(",true,data_lost+crc_mismatch,")) << done.out;
  EXPECT_THAT(lines_of(done.out).at(5), HasSubstr(",false,,")) << done.out;
  const json stats = json::parse(done.err);
  EXPECT_EQ(stats.at("crc_matches"), 2);
  EXPECT_EQ(stats.at("crc_mismatches"), 1);
  EXPECT_EQ(stats.at("time_packets"), 0);
  EXPECT_EQ(stats.at("skipped").at("noise"), 5);
  EXPECT_THAT(run({"packets", "-", "--errors"}, bytes).err,
              HasSubstr("CRC of the revolutions: 2 right, 1 wrong"));
}

// The device leaves out a packet or two after three revolutions with a right CRC.
TEST(NewerDevices, CountsAtTheEnd_NameAWrongCrcOnlyWhereThereWasOne) {
  const std::string source = "sim:?ct_crc=true";
  const std::string lossy = source + "&fault=omit*1@2s+6ms";
  for (const char* command : {"scan", "dump"}) {
    const std::string count = command == std::string("scan") ? "16" : "21000";
    const std::string wanted = " lost, 1 revolution with a wrong CRC, 0 ";
    EXPECT_TRUE(g4lidar::test::comes_true(
        [&] { return run({command, lossy, "-n", count}).err.find(wanted) != std::string::npos; }));
    EXPECT_TRUE(g4lidar::test::comes_true(
        [&] { return run({command, source, "-n", "3"}).err.find("CRC") == std::string::npos; }));
  }
}

}  // namespace
