// SPDX-License-Identifier: MIT
// g4-dump record and replay, as a person runs them: on a simulated lidar in real time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "program.hpp"
#include "recorded.hpp"
#include "recording.hpp"
#include "support/patience.hpp"

namespace {

using cli::line_with;
using cli::outcome;
using cli::points_of;
using cli::program;
using cli::record_scans;
using cli::run;
using ::testing::HasSubstr;
using ::testing::StartsWith;
namespace fs = std::filesystem;

class Record : public cli::scratch {
 protected:
  void expect_verified(const std::string& name) {
    const outcome done = run({"replay", "--verify", path(name)});
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_THAT(done.err, HasSubstr(" bytes both ways as recorded"));
    EXPECT_EQ(done.out, "");
  }
  void expect_refused(const std::vector<std::string>& words, int code, const std::string& why) {
    const outcome done = run(words);
    EXPECT_EQ(done.code, code) << done.err;
    EXPECT_THAT(done.err, HasSubstr(why));
  }
};

TEST_F(Record, Replay_GivesTheSamePoints) {
  const std::string file = path("walk.mcap");
  const outcome made = record_scans(file, 4);
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_EQ(made.out, "");
  EXPECT_THAT(made.err, HasSubstr(" 4 scans"));
  EXPECT_THAT(line_with(made.err, "digest"), HasSubstr("digest of all bytes "));
  std::smatch counted;
  ASSERT_TRUE(std::regex_search(made.err, counted, std::regex(" with ([0-9]+ points) in ")));
  EXPECT_THAT(line_with(made.err, "digest"), HasSubstr(", of " + counted[1].str() + " "));
  expect_verified("walk.mcap");
  EXPECT_THAT(run({"replay", "--verify", file}).err, HasSubstr(" points as recorded"));
  const auto played = points_of(file);
  EXPECT_GT(played.size(), 4000U);
  EXPECT_EQ(played, points_of(file)) << "and again";
}

// Packets that were read together have one time.
TEST_F(Record, ReadsAtThePaceOfRevolutions) {
  const std::string file = path("long.mcap");
  ASSERT_EQ(record_scans(file, 15).code, 0);
  std::set<std::string> times;
  std::size_t packets = 0;
  for (const std::string& line : cli::lines_of(run({"packets", file}).out)) {
    if (line.find("< packet ") == std::string::npos) continue;
    ++packets;
    times.insert(line.substr(0, line.find(' ')));
  }
  EXPECT_GT(packets, 400U);
  EXPECT_LT(times.size(), packets / 2);
}

TEST_F(Record, RecordingOfARecording_HasTheSameDigests) {
  const std::string first = path("first.mcap");
  const std::string second = path("second.mcap");
  const outcome made = record_scans(first, 3);
  ASSERT_EQ(made.code, 0) << made.err;
  const outcome again = run({"record", first, second, "--no-scans"});
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_NE(line_with(made.err, "digest"), "");
  EXPECT_EQ(line_with(made.err, "digest"), line_with(again.err, "digest"));
  expect_verified("second.mcap");
  EXPECT_EQ(points_of(first), points_of(second));
  for (const std::string name : {"first", "second"}) {
    ASSERT_EQ(run({"convert", path(name + ".mcap"), path(name + ".bin")}).code, 0);
  }
  EXPECT_EQ(cli::read_file(path("first.bin")), cli::read_file(path("second.bin")));
}

TEST_F(Record, Scans_AreRecordedByDefault) {
  const std::vector<std::string> names{"--frame-id", "roof", "--topic", "/up/there"};
  ASSERT_EQ(record_scans(path("with.mcap"), 1, names).code, 0);
  EXPECT_THAT(record_scans(path("without.mcap"), 1, {"--no-scans"}).err,
              HasSubstr(" to it, 0 scans"));
  EXPECT_THAT(cli::read_file(path("with.mcap")), HasSubstr("sensor_msgs/msg/LaserScan"));
  EXPECT_THAT(cli::read_file(path("with.mcap")), HasSubstr("roof"));
  EXPECT_THAT(cli::read_file(path("with.mcap")), HasSubstr("/up/there"));
  EXPECT_TRUE(fs::exists(path("without.mcap")));
}

TEST_F(Record, RawBytesInAFileAreCounted) {
  cli::write_repeated(path("raw.bin"), cli::zero(0) + cli::turn(), 100'000);
  const outcome made = run({"record", path("raw.bin"), path("raw.mcap"), "--sample-rate", "1000"});
  ASSERT_EQ(made.code, 0) << made.err;
  expect_verified("raw.mcap");
  const auto rows = points_of(path("raw.mcap"));
  ASSERT_GT(rows.size(), 1000U);
  const double took_s =
      static_cast<double>(cli::number_in(rows.back(), 3) - cli::number_in(rows[1], 3)) / 1e9;
  EXPECT_NEAR(took_s, static_cast<double>(rows.size()) / 1000.0, 1.0);
  ASSERT_EQ(run({"convert", path("raw.mcap"), path("again.bin")}).code, 0);
  EXPECT_EQ(cli::read_file(path("again.bin")), cli::read_file(path("raw.bin")));
}

TEST_F(Record, Pipe_CanBeRecorded) {
  std::string bytes;
  for (int i = 0; i < 20; ++i) bytes += cli::zero(0) + cli::turn();
  const outcome made = run({"record", "-", path("pipe.mcap")}, bytes);
  ASSERT_EQ(made.code, 0) << made.err;
  expect_verified("pipe.mcap");
  ASSERT_EQ(run({"convert", path("pipe.mcap"), path("pipe.bin")}).code, 0);
  EXPECT_EQ(cli::read_file(path("pipe.bin")), bytes);
}

TEST_F(Record, Signal_CompletesTheFile) {
  program interrupted({"record", "sim:", path("int.mcap")});
  program terminated({"record", "sim:", path("term.mcap")});
  for (const char* const name : {"int.mcap", "term.mcap"}) {
    ASSERT_TRUE(g4lidar::test::comes_true([&] { return points_of(path(name)).size() > 1; }));
  }
  interrupted.send(SIGINT);
  terminated.send(SIGTERM);
  for (program* const each : {&interrupted, &terminated}) {
    const outcome done = each->wait();
    EXPECT_EQ(done.code, 128 + (each == &interrupted ? SIGINT : SIGTERM));
    EXPECT_THAT(done.err, HasSubstr("digest of all bytes"));
  }
  expect_verified("int.mcap");
  expect_verified("term.mcap");
}

TEST_F(Record, FilesAreRotated) {
  const outcome made = run({"record", "sim:", path("day.mcap"), "--rotate-time", "1s", "-d", "4s"});
  ASSERT_EQ(made.code, 0) << made.err;
  const std::vector<std::string> names = cli::lines_of(listing());
  ASSERT_GE(names.size(), 3U);
  EXPECT_EQ(names[0], "day-0001.mcap");
  EXPECT_EQ(names.back(), "day.mcap");
  for (const std::string& name : names) expect_verified(name);
  EXPECT_GT(points_of(path("day-0001.mcap")).size(), 1000U) << "it can be played by itself";
  std::string bytes;
  for (const std::string& name : names) {
    if (name == "day.mcap") continue;
    ASSERT_EQ(run({"convert", path(name), path("part.bin"), "--force"}).code, 0);
    bytes += cli::read_file(path("part.bin"));
  }
  EXPECT_GT(bytes.size(), 20'000U);
}

TEST_F(Record, InvalidOptions_AreRefused) {
  expect_refused({"record", "sim:"}, 2, "no output file");
  expect_refused({"record", "sim:", "-o", "-"}, 2, "not to standard output");
  expect_refused({"record", "sim:", "-o", path("out.csv")}, 2, "record writes MCAP files");
  expect_refused({"record", "sim:", path("a.mcap"), "-o", path("b.mcap")}, 2,
                 "unexpected argument");
  expect_refused({"record", "sim:", path("a.mcap"), "--rotate-size", "1x"}, 2, "is not a size");
  expect_refused({"record", "sim:", path("a.mcap"), "--rotate-size", "10k"}, 2, "is below 1M");
  expect_refused({"record", "sim:", path("a.mcap"), "--rotate-time", "10ms"}, 2, "is below 1s");
  expect_refused({"record", "sim:", path("a.mcap"), "--topic", "scan"}, 2, "topic");
  expect_refused({"record", "sim:", path("no/a.mcap")}, 10, "Make its directory first");
  EXPECT_EQ(listing(), "");
}

TEST_F(Record, FullDisk_EndsItAndKeepsWrittenData) {
  const outcome done =
      cli::run_on_full_disk(120'000, {"record", "sim:", path("walk.mcap"), "-d", "20s"});
  EXPECT_EQ(done.code, 10) << done.err;
  EXPECT_THAT(done.err, HasSubstr("File too large. Free some space"));
  EXPECT_GT(points_of(path("walk.mcap")).size(), 1000U);
}

TEST_F(Record, ADeviceNeedsNoForce) {
  const outcome done = run({"record", "sim:", "-n", "2", "-o", "/dev/null"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

class Replay : public Record {};

TEST_F(Replay, Loop_DoesNotEnd) {
  ASSERT_EQ(record_scans(path("walk.mcap"), 2).code, 0);
  const outcome done = run({"replay", path("walk.mcap"), "--playback-speed", "max", "--loop",
                            "--scans", "-f", "csv", "-n", "20"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(cli::lines_of(done.out).size(), 21U);
}

TEST_F(Replay, PartOfARecording) {
  cli::record_in_virtual_time(path("walk.mcap"), 20);
  const auto all = points_of(path("walk.mcap"));
  const auto part = points_of(path("walk.mcap"), {"--from", "1600ms", "--to", "2200ms"});
  ASSERT_GT(part.size(), 100U);
  EXPECT_LT(part.size(), all.size() * 3 / 4);
  EXPECT_GE(cli::number_in(part[1], 3), cli::number_in(all[1], 3));
  EXPECT_LE(cli::number_in(part.back(), 3) - cli::number_in(part[1], 3), 700'000'000);
}

TEST_F(Replay, Verify_DetectsChanges) {
  ASSERT_EQ(record_scans(path("walk.mcap"), 3).code, 0);
  const std::string good = cli::read_file(path("walk.mcap"));
  ASSERT_EQ(run({"convert", path("walk.mcap"), path("walk.bin")}).code, 0);
  const std::size_t place = cli::place_of_payload(good, cli::read_file(path("walk.bin")));
  cli::write_file(path("bad.mcap"), cli::damaged(good, place));
  expect_refused({"replay", "--verify", path("bad.mcap")}, 10, "is damaged");
  cli::write_file(path("cut.mcap"), good.substr(0, good.size() * 2 / 3));
  expect_refused({"replay", "--verify", path("cut.mcap")}, 10, "was cut off");
  EXPECT_GT(points_of(path("cut.mcap")).size(), 500U) << "what is whole is played";
}

// As a recording from before the direction of no-returns was changed, which had no version.
TEST_F(Replay, PointsOfAnotherVersionAreNotCompared) {
  ASSERT_EQ(record_scans(path("walk.mcap"), 2).code, 0);
  std::string file = cli::read_file(path("walk.mcap"));
  const auto alter = [&](const std::string& name, std::size_t at, char wanted) {
    const std::size_t place = file.find(name);
    ASSERT_NE(place, std::string::npos) << name;
    file[place + at] = wanted;
  };
  const std::string points = "points" + std::string("\x10\0\0\0", 4);  // 16 digits follow
  const std::size_t digits = file.find(points) + points.size();
  file[digits] = file[digits] == '0' ? '1' : '0';
  cli::write_file(path("altered.mcap"), file);
  expect_refused({"replay", "--verify", path("altered.mcap")}, 10, "with the digest");
  alter("points_version", 0, 'P');
  cli::write_file(path("old.mcap"), file);
  const outcome done = run({"replay", "--verify", path("old.mcap")});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr(" bytes both ways as recorded"));
  EXPECT_THAT(done.err, HasSubstr("points were computed by another version"));
}

TEST_F(Replay, OtherFiles_AreRefused) {
  cli::write_file(path("empty"), "");
  cli::write_file(path("text.mcap"), "dear\n");
  const std::string magic = "\x89MCAP0\r\n";
  cli::write_file(path("magic.mcap"), magic);
  // A file of somebody else: a header, no lidar, and the end of the data.
  const std::string header = std::string("\x01\x08\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0", 17);
  const std::string end = std::string("\x0F\x04\0\0\0\0\0\0\0\0\0\0\0", 13);
  const std::string footer = std::string("\x02\x14", 2) + std::string(27, '\0');
  cli::write_file(path("foreign.mcap"), magic + header + end + footer + magic);
  for (const std::string name : {"empty", "text.mcap", "magic.mcap", "foreign.mcap", "none"}) {
    const outcome done = run({"replay", path(name)});
    EXPECT_EQ(done.code, 10) << name << ": " << done.err;
    EXPECT_THAT(done.err, StartsWith("g4-dump: ")) << name;
    EXPECT_EQ(run({"replay", "--verify", path(name)}).code, 10) << name;
  }
  expect_refused({"replay", path("text.mcap"), "--verify", "--loop"}, 2, "--loop");
  expect_refused({"replay", path("text.mcap"), "--playback-speed", "fast"}, 2, "fast");
}

}  // namespace
