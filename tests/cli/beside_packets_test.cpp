// SPDX-License-Identifier: MIT
// What is in a file beside packets is a warning of the verbs that read it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "program.hpp"
#include "recording.hpp"

namespace {

using cli::outcome;
using cli::run;
using cli::small_recording;
using ::testing::HasSubstr;
using ::testing::Not;
using namespace std::string_literals;

/// RFC 854: negotiation, and each FF is two.
std::string through_telnet(const std::string& all) {
  std::string text = "\xFF\xFB\x03\xFF\xFD\x03\xFF\xFB\x01";
  for (const char byte : all) text.append(byte == '\xFF' ? 2 : 1, byte);
  return text;
}

struct content {
  std::string bytes;
  std::string warning;
};

class BesidePackets : public cli::scratch {
 protected:
  const std::vector<content> contents_{
      {through_telnet(small_recording()), "speaks telnet"},
      {"\xFA\xFA\xA5\x5A\x14\x00\xE3\x02\x01"s + "COIN-D4" + small_recording(), "a COIN-D4"}};
};

TEST_F(BesidePackets, WhatIsThereIsAWarningOfEachVerb) {
  for (const content& each : contents_) {
    std::ofstream(path("in.bin"), std::ios::binary) << each.bytes;
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
             {"decode", path("in.bin")},
             {"decode", "--model", "g4", path("in.bin")},
             {"dump", path("in.bin")},
             {"convert", path("in.bin"), path("out.csv"), "--force"},
             {"convert", path("in.bin"), path("out.mcap"), "--force"}}) {
      const outcome done = run(words);
      EXPECT_EQ(done.code, 0) << words[0] << done.err;
      EXPECT_THAT(done.err, HasSubstr(each.warning)) << words[0] << ' ' << words[2 % words.size()];
    }
    const outcome piped = run({"decode", "-"}, each.bytes);
    EXPECT_EQ(piped.code, 0) << piped.err;
    EXPECT_THAT(piped.err, HasSubstr(each.warning));
    EXPECT_THAT(run({"decode", "-q", path("in.bin")}).err, Not(HasSubstr(each.warning)));
    EXPECT_THAT(run({"decode", "-"}, small_recording()).err, Not(HasSubstr(each.warning)));
  }
}

}  // namespace
