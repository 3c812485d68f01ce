// SPDX-License-Identifier: MIT
// g4-dump between pipes and signals: followed live, left by its reader, interrupted; and its memory.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <chrono>

#include <csignal>
#include <string>
#include <vector>

#include "program.hpp"
#include "recording.hpp"
#include "support/patience.hpp"

namespace {

using cli::outcome;
using cli::program;
using cli::stream;
using g4lidar::test::comes_true;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class Pipe : public cli::scratch {};

// Whether it lets go of its input, which nobody closes, within `patience`.
bool ends_with_open_input(const program& started) {
  return comes_true([&] { return started.input_is_dead(); });
}

TEST_F(Pipe, IsFollowedWhileItIsBeingWritten) {
  const std::string first = cli::packet(10, 20, {4000, 4004});
  const std::string second = cli::packet(30, 40, {4008, 4012});
  program started({"decode", "-"});
  started.feed(first + second.substr(0, 9));
  EXPECT_THAT(started.read_until("1001.00,111111\n"), StartsWith("scan,angle_deg"));
  started.feed(second.substr(9));
  started.read_until("1003.00,333333\n");
  EXPECT_EQ(started.wait().code, 0);
}

TEST_F(Pipe, JsonlFollowsRevolutionByRevolution) {
  program started({"decode", "-", "--format", "jsonl", "--scans"});
  started.feed(cli::zero(0) + cli::turn() + cli::zero(0));
  EXPECT_THAT(started.read_until("]}\n"), StartsWith(R"({"scan":0,"partial":false)"));
  EXPECT_EQ(started.wait().code, 0);
}

// A revolution takes longer than --idle: the bytes that come count, and not its records.
TEST_F(Pipe, IdleBeginsAgainWithEachByte) {
  const std::string turns = cli::zero(0) + cli::turn() + cli::zero(0);
  program started({"decode", "-", "--format", "jsonl", "--scans", "--idle", "4s"});
  const std::size_t piece = turns.size() / 12 + 1;
  for (std::size_t at = 0; at < turns.size(); at += piece) {
    started.feed(turns.substr(at, piece));
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
  }
  EXPECT_THAT(started.read_until("]}\n"), StartsWith(R"({"scan":0,"partial":false)"));
  EXPECT_EQ(started.wait().code, 0);
}

TEST_F(Pipe, Fifo_CanBeReadAndWritten) {
  const std::string in = path("in");
  const std::string out = path("out");
  ASSERT_EQ(::mkfifo(in.c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo(out.c_str(), 0600), 0);
  program started({"decode", in, "-o", out});
  cli::write_file(in, cli::zero(0));
  EXPECT_THAT(cli::read_file(out), StartsWith("scan,angle_deg"));
  EXPECT_EQ(started.wait().code, 0);
  EXPECT_EQ(listing(), "in\nout\n");
}

TEST_F(Pipe, ClosedPipe_IsASuccess) {
  const std::string name = path("long.bin");
  cli::write_repeated(name, cli::zero(0) + cli::turn(), 2'000'000);
  for (const char* const format : {"csv", "jsonl", "text"}) {
    program started({"decode", name, "--format", format});
    started.read_until("\n");
    started.close_output();
    const outcome done = started.wait();
    EXPECT_EQ(done.code, 0) << format;
    EXPECT_EQ(done.signal, 0) << format;
    EXPECT_THAT(done.err, HasSubstr("packets"));
  }
  program simulated({"sim", "--seconds", "1000000"});
  simulated.read_until("\xAA\x55");
  simulated.close_output();
  EXPECT_EQ(simulated.wait().code, 0);
}

TEST_F(Pipe, ClosedPipe_IsDetectedWhileTheInputIsSilent) {
  program started({"decode", "-"});
  started.feed(cli::zero(0));
  started.read_until("1000.00");
  started.close_output();
  // Its input stays open and silent; it ends all the same, and its end of the pipe with it.
  EXPECT_TRUE(ends_with_open_input(started));
  EXPECT_EQ(started.wait().code, 0);
}

TEST_F(Pipe, Interrupted_WritesItsDataAndTheCounts) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    program started({"decode", "-", "--stats", "json"});
    started.feed(cli::zero(0) + cli::turn(9) + cli::zero(0).substr(0, 5));
    started.read_until("40000000\n");
    started.send(signal);
    EXPECT_TRUE(ends_with_open_input(started)) << "it waits for the end of its input";
    const outcome done = started.wait();
    EXPECT_EQ(done.code, 128 + signal);
    EXPECT_EQ(cli::lines_of(done.out).size(), 1U + 361U);
    EXPECT_EQ(done.err, R"({"bytes":827,"packets":10,"responses":0,"points":361,"suspect":0,)"
                        R"("time_packets":0,"empty_packets":0,"crc_matches":0,"crc_mismatches":0,)"
                        R"("skipped":{"noise":0,"bad_header":0,"bad_checksum":0,"truncated":5}})"
                        "\n");
  }
}

TEST_F(Pipe, Interrupted_KeepsTheFileWithTheDataSoFar) {
  const std::string out = path("out.jsonl");
  const std::string live = path("live");
  ASSERT_EQ(::mkfifo(live.c_str(), 0600), 0);
  program started({"decode", live, "--format", "jsonl", "-o", out});
  const int writer = ::open(live.c_str(), O_WRONLY);
  const std::string data = cli::zero(0) + cli::turn();
  ASSERT_EQ(::write(writer, data.data(), data.size()), static_cast<ssize_t>(data.size()));
  ASSERT_TRUE(comes_true([&] {
    int left = -1;
    return ::ioctl(writer, FIONREAD, &left) == 0 && left == 0;
  })) << "it has not read everything";
  EXPECT_FALSE(std::filesystem::exists(out)) << "it appears when it is finished";
  started.send(SIGINT);
  EXPECT_EQ(started.wait().code, 130);
  ::close(writer);
  EXPECT_EQ(cli::lines_of(cli::read_file(out)).size(), 361U);
  EXPECT_EQ(listing(), "live\nout.jsonl\n");
}

TEST_F(Pipe, InterruptedBeforeAPacket_LeavesNoFile) {
  program started({"decode", "-", "-o", path("out.csv")});
  started.feed("boot text");
  ASSERT_TRUE(comes_true([&] { return started.has_read_its_input(); }));
  started.send(SIGINT);
  EXPECT_EQ(started.wait().code, 130);
  EXPECT_EQ(listing(), "");
}

TEST_F(Pipe, InterruptedSimulation_LeavesNoFile) {
  program started({"sim", "--seconds", "100000000", "-o", path("x"), "--truth", path("y")});
  ASSERT_TRUE(comes_true([&] { return !listing().empty(); }));
  started.send(SIGINT);
  EXPECT_EQ(started.wait().code, 130);
  EXPECT_EQ(listing(), "");
}

// Everything that a terminal on standard error is shown.
std::string shown_on_terminal(const std::vector<std::string>& arguments, const std::string& out) {
  int ours = -1;
  int theirs = -1;
  if (::openpty(&ours, &theirs, nullptr, nullptr, nullptr) != 0) return "no terminal";
  ::fcntl(ours, F_SETFD, FD_CLOEXEC);
  std::string shown;
  program started(arguments, {{}, stream::of_file(out), stream::of(theirs)});
  ::close(theirs);
  char part[4096];
  for (ssize_t count = 0; (count = ::read(ours, part, sizeof part)) > 0;) {
    shown.append(part, static_cast<std::size_t>(count));
  }
  ::close(ours);
  EXPECT_EQ(started.wait().code, 0);
  return shown;
}

TEST_F(Pipe, AProgressBarOnATerminalForLargeFilesOnly) {
  const std::string block = cli::zero(0) + cli::turn();
  const std::string small = path("small.bin");
  const std::string large = path("large.bin");
  cli::write_repeated(small, block, 100'000);
  cli::write_repeated(large, block, 17'000'000);
  const std::string bar =
      shown_on_terminal({"decode", large, "--valid", "--model", "g4"}, "/dev/null");
  EXPECT_THAT(bar, StartsWith("\r["));
  EXPECT_THAT(bar, HasSubstr("% "));
  EXPECT_THAT(bar, HasSubstr("\r\x1b[K17"));  // wiped away before the counts
  EXPECT_THAT(shown_on_terminal({"decode", small, "--model", "g4"}, "/dev/null"), StartsWith("1"));
  EXPECT_THAT(shown_on_terminal({"decode", large, "--stats", "json"}, "/dev/null"),
              StartsWith("{"));
  program unseen({"decode", large, "--model", "g4"}, {{}, stream::of_file("/dev/null"), {}});
  EXPECT_THAT(unseen.wait().err, StartsWith("17"));
}

TEST_F(Pipe, BinaryOnATerminal_IsRefused) {
  int ours = -1;
  int theirs = -1;
  ASSERT_EQ(::openpty(&ours, &theirs, nullptr, nullptr, nullptr), 0);
  program simulated({"sim"}, {{}, stream::of(theirs), {}});
  const outcome done = simulated.wait();
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, HasSubstr("-o FILE"));
  program waiting({"decode"}, {stream::of(theirs), {}, {}});
  const outcome refused = waiting.wait();
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("standard input is a terminal"));
  ::close(theirs);
  ::close(ours);
}

}  // namespace
