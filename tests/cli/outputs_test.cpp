// SPDX-License-Identifier: MIT
// What a command writes: never one of its inputs, under whatever name; an existing file only with --force, and only when
// there is something to write; and nothing of it remains on a full disk.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "program.hpp"
#include "recorded.hpp"

namespace {

using cli::outcome;
using cli::record_scans;
using cli::run;
using cli::run_on_full_disk;
using cli::stream;
using ::testing::HasSubstr;
using ::testing::Not;
using words = std::vector<std::string>;
namespace fs = std::filesystem;

constexpr const char* room = "wall 2 2 -2 2\nwall -2 2 -2 -2\nwall -2 -2 2 -2\nwall 2 -2 2 2\n";

/// `one` and `more`.
words joined(words one, const words& more) {
  one.insert(one.end(), more.begin(), more.end());
  return one;
}

class Outputs : public cli::scratch_here {
 protected:
  static void SetUpTestSuite() {
    directory_of_inputs() =
        fs::temp_directory_path() / ("g4-outputs-" + std::to_string(::getpid()));
    fs::create_directory(directory_of_inputs());
    const fs::path from = directory_of_inputs();
    ASSERT_EQ(record_scans(from / "walk.mcap", 3).code, 0);
    cli::write_file(from / "room.txt", room);
    cli::write_file(from / "way.txt", "drive forward 0.3 0.3\n");
    cli::write_file(from / "mask.txt", "polygon 1 1 2 1 2 2\n");
    ASSERT_EQ(run({"sim", "--seconds", "1", "--path", from / "way.txt", "--odometry",
                   from / "way.odo", "-o", from / "walk.bin"})
                  .code,
              0);
    ASSERT_EQ(run({"convert", from / "walk.bin", from / "walk.csv"}).code, 0);
    fs::copy(from / "walk.bin", from / "bytes");
  }
  static void TearDownTestSuite() { fs::remove_all(directory_of_inputs()); }
  static fs::path& directory_of_inputs() {
    static fs::path made;
    return made;
  }
  Outputs() {
    for (const auto& each : fs::directory_iterator(directory_of_inputs()))
      fs::copy(each.path(), directory_);
  }

  /// Refused, and `input` is what it was.
  void expect_kept(const std::string& input, const words& line) {
    const std::string before = cli::read_file(input);
    const outcome done = run(line);
    EXPECT_EQ(done.code, 2) << done.err;
    EXPECT_THAT(done.err, HasSubstr("is also the input"));
    EXPECT_TRUE(fs::exists(input));
    EXPECT_EQ(cli::read_file(input), before);
  }
};

struct use {
  std::string input;
  words line;  ///< OUT stands for a name of the input.
};

// Each verb that writes, with each kind of input that it has; OUT has the suffix that the verb wants.
const std::vector<use>& uses() {
  static const std::vector<use> all{
      {"walk.mcap", {"record", "walk.mcap", "-o", "OUT"}},
      {"walk.mcap", {"record", "walk.mcap", "OUT"}},
      {"bytes", {"record", "file:bytes", "-o", "OUT"}},
      {"way.odo", {"record", "walk.bin", "-o", "OUT", "--odometry", "way.odo"}},
      {"room.txt", {"record", "sim:?world=room.txt", "-o", "OUT", "-n", "1"}},
      {"walk.mcap", {"convert", "walk.mcap", "OUT", "--to-format", "csv"}},
      {"walk.mcap", {"convert", "walk.mcap", "OUT", "--to-format", "mcap"}},
      {"walk.mcap", {"convert", "walk.mcap", "OUT", "--to-format", "bin"}},
      {"walk.mcap", {"convert", "walk.mcap", "OUT", "--to-format", "pcd"}},
      {"walk.csv", {"convert", "walk.csv", "OUT", "--to-format", "npy"}},
      {"way.odo", {"convert", "walk.bin", "OUT", "--odometry", "way.odo", "--to-format", "tum"}},
      {"mask.txt", {"convert", "walk.bin", "OUT", "--mask", "mask.txt", "--to-format", "csv"}},
      {"walk.mcap", {"dump", "walk.mcap", "-o", "OUT"}},
      {"walk.mcap", {"scan", "walk.mcap", "-o", "OUT"}},
      {"mask.txt", {"scan", "sim:", "-n", "1", "--mask", "mask.txt", "-o", "OUT"}},
      {"way.txt", {"dump", "sim:?path=way.txt", "-n", "1", "-o", "OUT"}},
      {"walk.bin", {"decode", "walk.bin", "-o", "OUT"}},
      {"walk.mcap", {"replay", "walk.mcap", "--playback-speed", "max", "-o", "OUT"}},
      {"walk.bin", {"packets", "walk.bin", "-o", "OUT"}},
      {"walk.mcap", {"packets", "walk.mcap", "-o", "OUT"}},
      {"walk.mcap", {"stats", "walk.mcap", "-o", "OUT"}},
      {"walk.mcap", {"doctor", "walk.mcap", "-o", "OUT"}},
      {"walk.bin", {"doctor", "walk.bin", "--report", "OUT"}},
      {"room.txt", {"doctor", "sim:?world=room.txt", "--report", "OUT"}},
      {"room.txt", {"info", "sim:?world=room.txt", "-o", "OUT"}},
      {"room.txt", {"sim", "--seconds", "1", "--world", "room.txt", "-o", "OUT"}},
      {"room.txt",
       {"sim", "--seconds", "1", "--world", "room.txt", "-o", "new.bin", "--truth", "OUT"}},
      {"way.txt",
       {"sim", "--seconds", "1", "--path", "way.txt", "-o", "new.bin", "--odometry", "OUT"}},
      {"room.txt", {"acceptance", "--alone", "-d", "1s", "sim:?world=room.txt", "--file", "OUT"}},
  };
  return all;
}

TEST_F(Outputs, NeverAreAnInput_UnderAnyName) {
  for (const use& each : uses()) {
    fs::create_symlink(each.input, "symbolic");
    fs::create_hard_link(each.input, "hard");
    for (const std::string& name :
         {each.input, "./" + each.input, std::string("symbolic"), std::string("hard")}) {
      words line = each.line;
      std::ranges::replace(line, "OUT", name);
      SCOPED_TRACE(testing::PrintToString(line));
      expect_kept(each.input, line);
      expect_kept(each.input, joined(line, {"--force"}));
    }
    fs::remove("symbolic");
    fs::remove("hard");
  }
}

TEST_F(Outputs, NeverAreStandardInput) {
  const std::string before = cli::read_file("bytes");
  for (const words& line : {words{"decode", "-", "-o", "bytes", "--force"},
                            {"record", "-", "-o", "bytes", "--force"},
                            {"convert", "-", "bytes", "--to-format", "csv", "--force"}}) {
    cli::program started(line, {stream::of_file("bytes"), {}, {}});
    const outcome done = started.wait();
    EXPECT_EQ(done.code, 2) << line[0];
    EXPECT_THAT(done.err, HasSubstr("is also the input"));
    EXPECT_EQ(cli::read_file("bytes"), before);
  }
}

TEST_F(Outputs, NeverAreAnotherOutput) {
  for (const words& more : {words{"--truth", "a"},
                            {"--truth", "./a"},
                            {"--odometry", "a"},
                            {"--odometry", "../" + directory_.filename().string() + "/a"}}) {
    const outcome done = run(joined({"sim", "--seconds", "1", "-o", "a"}, more));
    EXPECT_EQ(done.code, 2) << more[1];
    EXPECT_THAT(done.err, HasSubstr("is also another output"));
    EXPECT_FALSE(fs::exists("a"));
  }
  EXPECT_EQ(run({"sim", "-o", "-", "--truth", "-"}).code, 2);
  EXPECT_EQ(run({"doctor", "walk.bin", "--report", "a.txt", "-o", "a.txt"}).code, 2);
}

// The advice of SUPPORT.md, with a name that makes the recording of the report the examined one.
TEST_F(Outputs, ReportOfARecording_LeavesIt) {
  const std::string before = cli::read_file("walk.mcap");
  for (const words& more : {words{}, {"--force"}}) {
    const outcome done =
        run(joined({"doctor", "walk.mcap", "-d", "1s", "--report", "walk.txt"}, more));
    EXPECT_THAT(done.err, HasSubstr("'walk.txt' and 'walk.mcap' are what a report"));
    EXPECT_EQ(cli::read_file("walk.mcap"), before);
    EXPECT_THAT(cli::read_file("walk.txt"), HasSubstr("The recording walk.mcap contains"));
  }
  cli::write_file("room.mcap", room);
  expect_kept("room.mcap", {"doctor", "sim:?world=room.mcap", "--report", "room.text", "--force"});
}

struct writing {
  words line;
  std::string output;
};

// A command line for each verb with -o, and for each other option that names an output.
std::vector<writing> writings() {
  return {{{"list"}, "-o"},
          {{"watch", "-d", "10ms"}, "-o"},
          {{"info", "sim:"}, "-o"},
          {{"health", "sim:"}, "-o"},
          {{"stats", "walk.mcap"}, "-o"},
          {{"doctor", "walk.bin"}, "-o"},
          {{"doctor", "walk.bin"}, "--report"},
          {{"dump", "sim:", "-n", "10"}, "-o"},
          {{"scan", "walk.mcap"}, "-o"},
          {{"packets", "walk.bin"}, "-o"},
          {{"decode", "walk.bin"}, "-o"},
          {{"sim", "--seconds", "1"}, "-o"},
          {{"sim", "--seconds", "1", "-o", "/dev/null"}, "--truth"},
          {{"sim", "--seconds", "1", "-o", "/dev/null"}, "--odometry"},
          {{"replay", "walk.mcap", "--playback-speed", "max"}, "-o"},
          {{"record", "walk.mcap"}, "-o"},
          {{"acceptance", "--alone", "-d", "1s", "sim:"}, "-o"},
          {{"acceptance", "--alone", "-d", "1s", "sim:"}, "--file"},
          {{"view", "--once", "walk.mcap"}, "-o"}};
}

TEST_F(Outputs, ExistingFile_IsReplacedOnRequestOnly) {
  cli::write_file("old", "dear");
  fs::create_symlink("old", "symbolic");
  for (const writing& each : writings()) {
    for (const std::string name : {"old", "symbolic"}) {
      const outcome done = run(joined(each.line, {each.output, name}));
      EXPECT_EQ(done.code, 10) << each.line[0] << done.err;
      EXPECT_THAT(done.err, HasSubstr("it exists already. Give another name, or --force"));
      EXPECT_EQ(cli::read_file("old"), "dear") << each.line[0];
    }
    if (each.line[0] == "acceptance") continue;  // takes long
    static_cast<void>(run(joined(each.line, {each.output, "symbolic", "--force"})));
    EXPECT_TRUE(fs::is_symlink("symbolic")) << each.line[0];
    EXPECT_NE(cli::read_file("old"), "dear") << each.line[0];
    cli::write_file("old", "dear");
  }
}

TEST_F(Outputs, ExistingFileOfConvert_IsReplacedOnRequestOnly) {
  for (const std::string name : {"o.mcap", "o.bin", "o.csv", "o.npy", "o.carmen", "o-0001.pcd"}) {
    cli::write_file(name, "dear");
    const words line{"convert", "walk.bin", name == "o-0001.pcd" ? "o-%04d.pcd" : name};
    const outcome refused = run(line);
    EXPECT_EQ(refused.code, 10) << name;
    EXPECT_THAT(refused.err,
                HasSubstr(name + "': it exists already. Give another name, or --force"));
    EXPECT_EQ(cli::read_file(name), "dear");
    EXPECT_EQ(run(joined(line, {"--force"})).code, 0) << name;
    EXPECT_GT(fs::file_size(name), 1000U) << name;
  }
}

// No verb is left out above.
TEST_F(Outputs, EachVerbThatWritesIsTried) {
  std::vector<std::string> tried;
  for (const writing& each : writings()) tried.push_back(each.line[0]);
  int found = 0;
  for (const std::string& line : cli::lines_of(run({"--complete", ""}).out)) {
    const std::string verb = line.substr(0, line.find('\t'));
    const std::string help = run({verb, "--help"}).out;
    if (help.find("--output") == std::string::npos) continue;
    ++found;
    EXPECT_THAT(help, HasSubstr("--force")) << verb;
    EXPECT_NE(std::ranges::find(tried, verb), tried.end()) << verb;
  }
  EXPECT_GE(found, 14);
}

TEST_F(Outputs, WhatIsNotOnDisk_NeedsNoForce) {
  for (const std::string name : {"/dev/null", "/dev/stdout"}) {
    EXPECT_EQ(run({"dump", "sim:", "-n", "10", "-o", name}).code, 0) << name;
    EXPECT_EQ(run({"sim", "--seconds", "1", "-o", name}).code, 0) << name;
    EXPECT_EQ(run({"convert", "walk.bin", name, "--to-format", "csv"}).code, 0) << name;
  }
  cli::write_file("redirected", "");
  cli::program started({"scan", "walk.mcap", "-f", "csv", "-o", "/dev/stdout"},
                       {{}, stream::of_file("redirected"), {}});
  EXPECT_EQ(started.wait().code, 0);
  EXPECT_THAT(cli::read_file("redirected"), HasSubstr("measured_hz"));
}

TEST_F(Outputs, WithoutAnythingToWrite_TheOldFileStays) {
  cli::write_file("old.mcap", "dear");
  for (const words& line : {words{"record", "/dev/nosuch"},
                            {"record", "tcp:localhost:1"},
                            {"record", "nosuch.bin"},
                            {"record", "sim:?world=nosuch.txt"},
                            {"dump", "tcp:localhost:1"},
                            {"dump", "sim:?fault=mute@0"},
                            {"scan", "tcp:localhost:1"},
                            {"decode", "nosuch.bin"},
                            {"decode", "room.txt"},
                            {"sim", "--world", "nosuch.txt"}}) {
    EXPECT_NE(run(joined(line, {"-o", "old.mcap", "--force"})).code, 0) << line[1];
    EXPECT_EQ(cli::read_file("old.mcap"), "dear") << line[0] << " " << line[1];
    EXPECT_NE(run(joined(line, {"-o", "new.mcap"})).code, 0) << line[1];
    EXPECT_FALSE(fs::exists("new.mcap")) << line[1];
  }
  for (const auto& each : fs::directory_iterator("."))
    EXPECT_NE(each.path().extension(), ".tmp") << each.path();
  EXPECT_EQ(run({"record", "sim:", "-n", "1", "-o", "old.mcap", "--force"}).code, 0);
  EXPECT_EQ(run({"replay", "--verify", "old.mcap"}).code, 0);
}

// A night: a file of an older one does not end it, and stays.
TEST_F(Outputs, NumbersOfExistingFilesAreLeftOut) {
  cli::write_file("rr-0001.mcap", "dear");
  cli::write_file("rr-0003.mcap", "dear");
  for (const words& more : {words{}, {"--force"}}) {
    const outcome done = run(joined(
        {"record", "sim:?seed=3", "-o", "rr.mcap", "--rotate-time", "1s", "-d", "5s"}, more));
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(cli::read_file("rr-0001.mcap"), "dear");
    EXPECT_EQ(cli::read_file("rr-0003.mcap"), "dear");
    for (const std::string name : {"rr.mcap", "rr-0002.mcap", "rr-0004.mcap"})
      EXPECT_EQ(run({"replay", "--verify", name}).code, 0) << name;
  }
  EXPECT_THAT(run({"record", "--help"}).out, HasSubstr("next free number"));
}

// It is full before the lidar is opened, or while a recording begins.
TEST_F(Outputs, OnAFullDisk_ARecordingReplacesNothing) {
  cli::write_file("old.mcap", "dear");
  const std::size_t before = static_cast<std::size_t>(
      std::distance(fs::directory_iterator("."), fs::directory_iterator()));
  for (const std::uint64_t bytes : {10U, 700U}) {
    for (const words& line : {words{"record", "sim:", "-n", "1", "-o"},
                              {"record", "walk.mcap", "-o"},
                              {"acceptance", "--alone", "-d", "1s", "sim:", "--file"}}) {
      const outcome done = run_on_full_disk(bytes, joined(line, {"old.mcap", "--force"}));
      EXPECT_EQ(done.code, 10) << line[0] << bytes << done.err;
      EXPECT_THAT(done.err, HasSubstr("cannot write 'old.mcap': File too large. Free some space"));
      EXPECT_THAT(done.err, Not(HasSubstr("can be read")));
      EXPECT_EQ(cli::read_file("old.mcap"), "dear") << line[0] << bytes;
      EXPECT_EQ(run_on_full_disk(bytes, joined(line, {"new.mcap"})).code, 10) << line[0] << bytes;
      EXPECT_FALSE(fs::exists("new.mcap")) << line[0] << bytes;
    }
  }
  EXPECT_EQ(std::distance(fs::directory_iterator("."), fs::directory_iterator()),
            static_cast<std::ptrdiff_t>(before));
}

TEST_F(Outputs, OnAFullDisk_NothingOfItRemains) {
  for (const std::string name : {"full.mcap", "full.bin", "full.csv", "full.jsonl", "full.pcd",
                                 "full.npy", "full.npz", "full.ply", "full.xyz", "full.carmen"}) {
    for (const std::string from : {"walk.mcap", "walk.bin"}) {
      const outcome done = run_on_full_disk(3'000, {"convert", from, name});
      EXPECT_EQ(done.code, 10) << from << " to " << name << done.err;
      EXPECT_THAT(done.err, HasSubstr("File too large. Free some space"));
      EXPECT_THAT(done.err, Not(HasSubstr("can be read")));
      EXPECT_THAT(done.err, Not(HasSubstr("digest"))) << "there is no file that has it";
      EXPECT_FALSE(fs::exists(name)) << from << " to " << name;
    }
  }
  for (const auto& each : fs::directory_iterator("."))
    EXPECT_NE(each.path().extension(), ".tmp") << each.path();
}

}  // namespace
