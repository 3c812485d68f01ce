// SPDX-License-Identifier: MIT
// --model, and what raw bytes show: by every command that reads files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "program.hpp"
#include "support/family_reference.hpp"

namespace {

using cli::outcome;
using cli::program;
using cli::run;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

std::string t_mini_stream(unsigned revolutions) {
  const auto data = reference::t_mini_stream(revolutions);
  return {data.begin(), data.end()};
}

constexpr const char* report =
    "read as T-mini Pro: 3-byte samples with intensity do not name their model; --model names "
    "another one: g2, g4b, s2-intensity, s4b, scl\n";

outcome fed(const std::vector<std::string>& arguments, const std::string& bytes) {
  program started(arguments);
  started.feed(bytes);
  return started.wait();
}

class ModelOfAFile : public cli::scratch {
 protected:
  ModelOfAFile() {
    cli::write_file(raw_, t_mini_stream(20));
    EXPECT_EQ(run({"record", raw_, recorded_}).code, 0);
  }
  const std::string raw_ = path("raw.bin");
  const std::string recorded_ = path("walk.mcap");
};

TEST_F(ModelOfAFile, RawBytesAreRecognisedAndReported) {
  const outcome done = run({"dump", raw_, "-f", "csv", "-n", "40"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr(report));
  EXPECT_THAT(done.out, StartsWith("scan,angle_deg,range_mm,time_ns,intensity,sample_flags\n"
                                   "0,0.000000,2000.00,0,100,2\n"
                                   "0,0.500000,2000.00,250000,101,2\n"));
  EXPECT_THAT(run({"dump", raw_, "-q", "-n", "40"}).err, Not(HasSubstr("read as")));
  EXPECT_THAT(run({"dump", raw_, "--model", "t-mini-pro", "-n", "40"}).err,
              Not(HasSubstr("read as")));
  const std::string as_g4 = run({"dump", raw_, "--model", "g4", "-f", "csv", "-q"}).out;
  EXPECT_THAT(as_g4, Not(HasSubstr("intensity")));
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"decode", raw_},
                                             {"scan", raw_},
                                             {"stats", raw_},
                                             {"packets", raw_},
                                             {"view", raw_, "--once", "--frame", "vendor"},
                                             {"convert", raw_, path("out.csv"), "--force"},
                                             {"doctor", raw_},
                                             {"record", raw_, path("o.mcap"), "--force"}}) {
    const outcome each = run(words);
    EXPECT_EQ(each.code, 0) << words.front() << each.err;
    EXPECT_THAT(each.err, HasSubstr(report)) << words.front();
    EXPECT_EQ(each.err.find("read as"), each.err.rfind("read as")) << words.front();
  }
}

TEST_F(ModelOfAFile, APipeIsRecognisedAsAFile) {
  const std::string bytes = t_mini_stream(20);
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"dump", "-", "-f", "csv"},
                                             {"decode", "-"},
                                             {"scan", "-", "-f", "csv"},
                                             {"packets", "-"},
                                             {"record", "-", path("p.mcap"), "--force"}}) {
    const outcome piped = fed(words, bytes);
    EXPECT_EQ(piped.code, 0) << words.front() << piped.err;
    EXPECT_THAT(piped.err, HasSubstr(report)) << words.front();
    EXPECT_EQ(piped.err.find("read as"), piped.err.rfind("read as")) << words.front();
  }
  EXPECT_EQ(fed({"decode", "-"}, bytes).out, run({"decode", raw_}).out);
  const outcome wrong = fed({"decode", "-", "--model", "t-mini-plus-sh"}, bytes);
  EXPECT_EQ(wrong.code, 7);
  EXPECT_THAT(wrong.err, HasSubstr("packets with samples of 3 bytes"));
  EXPECT_EQ(run({"info", path("p.mcap")}).code, 0);
  EXPECT_THAT(run({"info", path("p.mcap")}).out, HasSubstr("T-mini Pro"));
  EXPECT_EQ(run({"convert", path("p.mcap"), path("p.bin")}).code, 0);
  EXPECT_EQ(cli::read_file(path("p.bin")), bytes);
}

TEST_F(ModelOfAFile, ARecordingStatesIt) {
  const outcome played = run({"replay", recorded_, "--playback-speed", "max", "-f", "csv"});
  EXPECT_EQ(played.code, 0) << played.err;
  EXPECT_THAT(played.out, StartsWith("scan,angle_deg,range_mm,time_ns,intensity,sample_flags\n"));
  EXPECT_THAT(played.out, HasSubstr(",112,2\n"));
  EXPECT_THAT(played.err, HasSubstr("read as T-mini Pro: its bytes do not name their model"));
  EXPECT_EQ(run({"replay", "--verify", recorded_}).code, 0);
  EXPECT_EQ(run({"replay", "--verify", recorded_, "--model", "t-mini-pro"}).code, 2) << "as it was";
  EXPECT_EQ(run({"doctor", recorded_}).code, 0);
  const std::string packets = run({"packets", recorded_}).out;
  EXPECT_THAT(packets, HasSubstr("30 samples"));
  EXPECT_THAT(packets, Not(HasSubstr("bad checksum")));
}

TEST_F(ModelOfAFile, BytesAreCutAtPacketsOfTheModel) {
  ASSERT_EQ(run({"convert", raw_, path("e.bin"), "--from", "0.1s"}).code, 0);
  EXPECT_GT(cli::read_file(path("e.bin")).size(), 1000U);
  EXPECT_LT(cli::read_file(path("e.bin")).size(), cli::read_file(raw_).size());
  EXPECT_THAT(cli::read_file(raw_), EndsWith(cli::read_file(path("e.bin"))));
  ASSERT_EQ(run({"convert", recorded_, path("d.mcap"), "--points"}).code, 0);
  EXPECT_THAT(cli::read_file(path("d.mcap")), HasSubstr("/g4lidar/v2/from_device"));
}

}  // namespace
