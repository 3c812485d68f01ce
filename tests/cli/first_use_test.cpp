// SPDX-License-Identifier: MIT
// What somebody meets who uses g4-dump for the first time: words that are almost right, no words at all, and a
// report of a problem.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/suggestion.hpp"
#include "program.hpp"
#include "simulator.hpp"
#include "support/patience.hpp"

namespace {

using cli::outcome;
using cli::program;
using cli::run;
using cli::stream;
using g4_tool::did_you_mean;
using g4lidar::test::comes_true;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// ---- did you mean ------------------------------------------------------------------------------

TEST(Suggestion, IsTheNearestWord) {
  const std::vector<std::string> verbs{"list", "scan",   "stats", "start",
                                       "stop", "doctor", "record"};
  EXPECT_EQ(did_you_mean("scna", verbs), "; did you mean 'scan'?");      // two letters swapped
  EXPECT_EQ(did_you_mean("sscan", verbs), "; did you mean 'scan'?");     // one too many
  EXPECT_EQ(did_you_mean("lst", verbs), "; did you mean 'list'?");       // one is missing
  EXPECT_EQ(did_you_mean("doktor", verbs), "; did you mean 'doctor'?");  // another one
  EXPECT_EQ(did_you_mean("SCAN", verbs), "; did you mean 'scan'?");
  EXPECT_EQ(did_you_mean("doc", verbs), "; did you mean 'doctor'?");  // the begin of one
  EXPECT_EQ(did_you_mean("frobnicate", verbs), "");
  EXPECT_EQ(did_you_mean("scan", verbs), "");
  EXPECT_EQ(did_you_mean("x", verbs), "");
  EXPECT_EQ(did_you_mean("", verbs), "");
  EXPECT_EQ(did_you_mean("5000", {"4000", "8000"}), "");  // a number that is near is another number
  EXPECT_EQ(did_you_mean(std::string(100'000, 's'), verbs), "");
}

void expect_suggestion(const std::vector<std::string>& arguments, const std::string& word) {
  const outcome done = run(arguments);
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, HasSubstr("; did you mean '" + word + "'? See: g4-dump"));
}

TEST(Suggestion, OfACommand) {
  expect_suggestion({"scna"}, "scan");
  expect_suggestion({"help", "recrod"}, "record");
  EXPECT_THAT(run({"frobnicate"}).err, Not(HasSubstr("did you mean")));
}

TEST(Suggestion, OfAnOption) {
  expect_suggestion({"scan", "--formt=csv"}, "--format");
  expect_suggestion({"scan", "--quite"}, "--quiet");  // of the program
  expect_suggestion({"list", "--porbe"}, "--probe");
  expect_suggestion({"serve", "--prot", "80"}, "--port");  // from the table of g4-serve
}

TEST(Suggestion, OfAValue) {
  expect_suggestion({"decode", "-f", "cvs"}, "csv");
  expect_suggestion({"set", "sampel_rate=9k"}, "sample_rate");
  expect_suggestion({"set", "direction=ccww"}, "ccw");
  expect_suggestion({"decode", "--speckle=windw=3"}, "window");
  expect_suggestion({"sim", "--link", "x", "--fault", "flpi*0.1%"}, "flip");
  expect_suggestion({"dump", "--frame", "robto"}, "robot");
}

TEST(Words, ScanNamesAllItsFormats) {
  const outcome done = run({"scan", "-f", "csvv"});
  EXPECT_EQ(done.code, 2);
  EXPECT_EQ(
      done.err,
      "g4-dump: --format: 'csvv' is not one of csv, jsonl, pcd, svg, text; did you mean 'csv'? "
      "See: g4-dump scan --help\n");
}

TEST(Words, SetOffersOneWordForOneThing) {
  const outcome done = run({"set", "frobnicate=on"});
  EXPECT_THAT(done.err, AllOf(HasSubstr("direction, constant, idle, protection"),
                              Not(HasSubstr("low-power"))));
  EXPECT_THAT(run({"set", "--help"}).out, Not(HasSubstr("low-power")));
  EXPECT_THAT(run({"--complete", "set", ""}).out,
              AllOf(HasSubstr("idle=on"), Not(HasSubstr("low-power"))));
}

// ---- without words -----------------------------------------------------------------------------

class FirstUse : public cli::scratch {
 protected:
  ~FirstUse() override { ::unsetenv("G4LIDAR_SIM_DIR"); }

  /// A simulated lidar that is discovered; the directory of its links.
  void make_registry() {
    std::filesystem::create_directory(path("ports"));
    ::setenv("G4LIDAR_SIM_DIR", path("ports").c_str(), 1);
  }

  /// The same with a lidar, when it can be discovered: its link there comes after the other one.
  void serve_registered() {
    make_registry();
    simulated_.emplace(path("g4"), std::vector<std::string>{"--register"});
    EXPECT_TRUE(comes_true([&] { return !std::filesystem::is_empty(path("ports")); }));
  }
  std::optional<cli::simulator> simulated_;

  /// What the program writes to a terminal on standard output.
  static std::string shown(const std::vector<std::string>& arguments) {
    int ours = -1;
    int theirs = -1;
    if (::openpty(&ours, &theirs, nullptr, nullptr, nullptr) != 0) return "no terminal";
    program started(arguments, {{}, stream::of(theirs), {}});
    ::close(theirs);
    std::string all;
    char part[4096];
    for (ssize_t count = 0; (count = ::read(ours, part, sizeof part)) > 0;) {
      all.append(part, static_cast<std::size_t>(count));
    }
    ::close(ours);
    const outcome done = started.wait();
    EXPECT_EQ(done.code, 0) << done.err;
    return all;
  }
};

TEST_F(FirstUse, WithoutWordsOnATerminal_ListsLidarsAndCommands) {
  serve_registered();
  const std::string all = shown({});
  EXPECT_THAT(all, HasSubstr(path("ports")));
  EXPECT_THAT(all, AllOf(HasSubstr("\r\n  doctor "), HasSubstr("\r\n  scan "),
                         HasSubstr("Print whole revolutions"), HasSubstr("--help")));
  EXPECT_THAT(shown({"-q", "--color", "never"}), HasSubstr("\r\n  scan "));
  EXPECT_THAT(simulated_->log(), Not(HasSubstr("start")));
}

TEST_F(FirstUse, WithoutWordsAndALidar_ShowsHowToTryIt) {
  make_registry();
  const std::string all = shown({});
  if (all.find("Ports with") != std::string::npos) GTEST_SKIP() << "this computer has a lidar";
  EXPECT_THAT(all, AllOf(HasSubstr("g4-dump view sim:"), HasSubstr("\r\n  scan ")));
}

// Scripts read points, as the documents promise.
TEST_F(FirstUse, WithoutWordsInAPipe_PrintsPoints) {
  serve_registered();
  program piped({"--quiet"});
  EXPECT_THAT(piped.read_until("\n"), HasSubstr("deg"));
  piped.send(SIGINT);
  EXPECT_EQ(piped.wait().code, 130);
}

// ---- a report of a problem ---------------------------------------------------------------------

TEST_F(FirstUse, Report_HasWhatIsNeeded) {
  const std::string text = path("report.txt");
  const outcome done = run({"doctor", "-d", "500ms", "sim:?seed=7", "--report", text});
  EXPECT_NE(done.code, 2)
      << done.err;  // what the doctor finds on a busy computer is not tested here
  EXPECT_EQ(listing(), "report.mcap\nreport.txt\n");
  EXPECT_THAT(done.err,
              AllOf(HasSubstr(text), HasSubstr(path("report.mcap")), HasSubstr("issues")));
  const std::string report = cli::read_file(text);
  EXPECT_THAT(report, HasSubstr("This file contains:"));
  EXPECT_THAT(report, HasSubstr("g4-dump doctor -d 500ms sim:?seed=7 --report " + text));
  EXPECT_THAT(report, HasSubstr("g4-dump      " + run({"--version"}).out.substr(8)));
  EXPECT_THAT(report, HasSubstr("kernel       Linux "));
  EXPECT_THAT(report, HasSubstr("\n== ports\n"));
  EXPECT_THAT(report, HasSubstr("\nbaud_rate    "));
  EXPECT_THAT(report, HasSubstr("sample_rate 9k\n"));
  EXPECT_THAT(report, HasSubstr("report.mcap: "));
  const outcome read = run({"scan", "-n", "1", path("report.mcap")});
  EXPECT_EQ(read.code, 0) << read.err;
}

TEST_F(FirstUse, Report_WithoutALidar_HasEverythingElse) {
  const std::string text = path("report");
  const outcome done = run({"doctor", "/dev/ttyNone9", "--report", text});
  EXPECT_EQ(done.code, 3);
  EXPECT_EQ(listing(), "report\n");
  EXPECT_THAT(done.err, AllOf(HasSubstr("'" + text + "' is what"), HasSubstr("attach it")));
  const std::string report = cli::read_file(text);
  EXPECT_THAT(report, AllOf(HasSubstr("== versions\n"), HasSubstr("kernel "), HasSubstr("FAIL"),
                            HasSubstr("== settings\nopening /dev/ttyNone9"),
                            HasSubstr("== recording\nopening /dev/ttyNone9")));
}

// A lidar that does not answer: the recording has what was sent and what came.
TEST_F(FirstUse, Report_OfASilentLidar_HasTheBytesOfTheAttempt) {
  const outcome done =
      run({"doctor", "-d", "500ms", "sim:?fault=mute", "--report", path("report.txt")});
  EXPECT_NE(done.code, 0);
  EXPECT_EQ(listing(), "report.mcap\nreport.txt\n");
}

TEST_F(FirstUse, Report_OfARecording_AsksForTheRecording) {
  ASSERT_EQ(run({"record", "sim:", "-n", "3", "-o", path("walk.mcap")}).code, 0);
  const outcome done = run({"doctor", path("walk.mcap"), "--report", path("report.txt")});
  EXPECT_THAT(done.err, HasSubstr("report.txt' and '" + path("walk.mcap") + "' are"));
  EXPECT_EQ(listing(), "report.txt\nwalk.mcap\n");
}

TEST_F(FirstUse, Report_ReplacesNoFileWithoutForce) {
  cli::write_file(path("report.mcap"), "older");
  const std::vector<std::string> words{"doctor", "/dev/ttyNone9", "--report", path("report.txt")};
  const outcome done = run(words);
  EXPECT_EQ(done.code, 10);
  EXPECT_EQ(done.out, "");
  EXPECT_THAT(done.err,
              HasSubstr("report.mcap': it exists already. Give another name, or --force"));
  EXPECT_EQ(listing(), "report.mcap\n");
  std::vector<std::string> forced = words;
  forced.emplace_back("--force");
  EXPECT_EQ(run(forced).code, 3);
  EXPECT_EQ(run({"doctor", "/dev/ttyNone9", "--report", path("a.mcap")}).code, 2);
}

}  // namespace
