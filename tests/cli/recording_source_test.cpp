// SPDX-License-Identifier: MIT
// A recording as SOURCE of the verbs that read one: whole, cut off, damaged, misnamed, in a pipe.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "program.hpp"
#include "recorded.hpp"

namespace {

using cli::lines_of;
using cli::outcome;
using cli::run;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr const char* exact_damage = " of the file skipped, ";

class RecordingSource : public cli::scratch {
 protected:
  void SetUp() override {
    const outcome made = cli::record_scans(whole_, 4);
    ASSERT_EQ(made.code, 0) << made.err;
  }

  /// All but a quarter of the second half's bytes; what came first is in a chunk of its own.
  [[nodiscard]] std::string cut_off() const {
    const std::string name = path("cut.mcap");
    const std::string bytes = cli::read_file(whole_);
    cli::write_file(name, bytes.substr(0, bytes.size() * 7 / 8));
    return name;
  }

  std::string whole_ = path("whole.mcap");
};

TEST_F(RecordingSource, EachVerbThatReadsTakesIt) {
  const outcome points = run({"dump", whole_, "-f", "csv"});
  EXPECT_EQ(points.code, 0) << points.err;
  EXPECT_GT(lines_of(points.out).size(), 3000U);
  EXPECT_EQ(lines_of(run({"scan", whole_, "-q"}).out).size(), 1U + 4U);
  const outcome packets = run({"packets", whole_});
  EXPECT_EQ(packets.code, 0) << packets.err;
  EXPECT_THAT(packets.out, HasSubstr(" > start  A5 60\n"));
  EXPECT_THAT(packets.out, HasSubstr(" zero packet, "));
  EXPECT_THAT(run({"info", whole_}).out, HasSubstr("serial      2021101000070073\n"));
}

TEST_F(RecordingSource, AnyNameWithoutAVerb_IsRecognised) {
  const std::string odd = path("odd");
  cli::write_file(odd, cli::read_file(whole_));
  const std::string wanted = run({"dump", whole_, "-q"}).out;
  EXPECT_EQ(run({odd, "-q"}).out, wanted);
  EXPECT_EQ(run({"-q", odd}).out, wanted);
  EXPECT_EQ(run({"-q", "dump", odd}).out, wanted);
  EXPECT_EQ(run({"--color", "never", "-q", "--json-errors", "dump", odd}).out, wanted);
}

// Its seconds are those of the recording, however fast it is read.
TEST_F(RecordingSource, Stats_UseTheTimesOfTheRecording) {
  const outcome done = run({"stats", whole_, "--json"});
  EXPECT_EQ(done.code, 0) << done.err;
  const std::size_t at = done.out.find("\"points_per_second\":");
  ASSERT_NE(at, std::string::npos);
  const double rate = std::stod(done.out.substr(at + 20));
  EXPECT_GT(rate, 7000.0);
  EXPECT_LT(rate, 11'000.0);
  EXPECT_THAT(done.out, HasSubstr("\"scans\":4,"));
}

TEST_F(RecordingSource, NothingAnswers) {
  for (const char* const verb : {"health", "start", "stop", "restart"}) {
    const outcome done = run({verb, whole_});
    EXPECT_EQ(done.code, 10) << verb << ": " << done.err;
    EXPECT_THAT(done.err, HasSubstr("a file cannot be asked or set"));
  }
  EXPECT_EQ(run({"set", whole_, "frequency=7"}).code, 10);
}

// What is whole is used, the rest is counted, whatever reads it.
TEST_F(RecordingSource, TruncationIsReported) {
  const std::string cut = cut_off();
  const std::vector<std::vector<std::string>> commands{
      {"dump", cut},    {"scan", cut},
      {"stats", cut},   {"replay", cut, "--playback-speed", "max"},
      {"packets", cut}, {"record", cut, "-o", path("again.mcap")}};
  for (const std::vector<std::string>& words : commands) {
    const outcome done = run(words);
    EXPECT_EQ(done.code, 0) << words[0] << ": " << done.err;
    EXPECT_THAT(done.err, HasSubstr("the file was cut off, ")) << words[0];
    EXPECT_THAT(done.err, HasSubstr(exact_damage)) << words[0];
  }
  EXPECT_THAT(run({"dump", whole_}).err, Not(HasSubstr(exact_damage)));
  EXPECT_EQ(run({"dump", cut, "-q"}).err, "");
}

TEST_F(RecordingSource, IsNoRawBytes) {
  const std::string bytes = cli::read_file(whole_);
  const std::vector<std::vector<std::string>> commands{
      {"dump", "-"}, {"scan", "-"}, {"packets", "-"}, {"decode", "-"}};
  for (const std::vector<std::string>& words : commands) {
    const outcome done = run(words, bytes);
    EXPECT_EQ(done.code, 10) << words[0];
    EXPECT_THAT(done.err, HasSubstr("standard input is a recording, not raw bytes.")) << words[0];
  }
  EXPECT_EQ(run({"decode", whole_}).code, 0) << "a recording by its name is played";
  const outcome recorded = run({"record", "-", "-o", path("again.mcap")}, bytes);
  EXPECT_EQ(recorded.code, 10) << recorded.err;
  EXPECT_THAT(recorded.err, HasSubstr("a recording in a pipe"));
}

// Who reads points has missed no scan, and who reads scans has missed no point.
TEST_F(RecordingSource, UnrequestedData_IsNotCountedAsMissed) {
  EXPECT_THAT(run({"dump", whole_}).err, HasSubstr(" lost, 0 points missed, "));
  EXPECT_THAT(run({"scan", whole_}).err, HasSubstr(" lost, 0 scans missed, "));
}

TEST(NoSource, MissingFileOrPort_IsReported) {
  const outcome file = run({"dump", "nowhere.mcap"});
  EXPECT_EQ(file.code, 10);
  EXPECT_THAT(file.err, StartsWith("g4-dump: there is no file 'nowhere.mcap'. Check the name"));
  const outcome other = run({"dump", "nowhere/at-all"});
  EXPECT_EQ(other.code, 3);
  EXPECT_THAT(other.err, HasSubstr("nowhere/at-all: there is no port and no file of this name"));
  EXPECT_THAT(run({"dump", "/dev/ttyNONE"}).err, HasSubstr("this port does not exist"));
  // A program that reads the object gets the same error as for every other missing port.
  EXPECT_THAT(run({"dump", "nowhere/at-all", "--json-errors"}).err,
              HasSubstr("\"problem\":\"no_port\""));
}

TEST(LostSource, Counts_AreReported) {
  const outcome packets = run({"packets", "sim:?fault=unplug@500ms"});
  EXPECT_EQ(packets.code, 9);
  EXPECT_THAT(packets.err, HasSubstr(" bytes skipped: "));
  const outcome stats = run({"stats", "sim:?fault=unplug@500ms", "--json"});
  EXPECT_EQ(stats.code, 9);
  EXPECT_THAT(stats.out, HasSubstr("\"reconnects\":0"));
}

// A scan all of whose revolutions are damaged writes none, and reports that.
TEST(DamagedScans, AreCountedWhereTheyAreLeftOut) {
  const outcome done = run({"scan", "sim:?fault=flip*0.2%&seed=3", "-d", "1500ms"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr(" left out; --partial includes them"));
}

TEST_F(RecordingSource, NothingWhole_IsABadFileAndNothingIsWritten) {
  std::string bytes = cli::read_file(whole_);
  const std::string name = path("noise.mcap");
  cli::write_file(name, bytes.substr(0, 8) + std::string(bytes.size(), '\x55'));
  const std::string before = listing();
  for (const char* const verb : {"dump", "scan"}) {
    const outcome done = run({verb, name, "-o", path("out.txt")});
    EXPECT_EQ(done.code, 10) << done.err;
    EXPECT_EQ(listing(), before) << verb;
  }
}

}  // namespace
