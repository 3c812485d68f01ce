// SPDX-License-Identifier: MIT
// g4-dump dump and scan on a simulated lidar: how they end, what they leave, and what a loss does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "program.hpp"
#include "simulator.hpp"
#include "support/patience.hpp"

namespace {

using cli::lines_of;
using cli::outcome;
using cli::program;
using cli::run;
using g4lidar::test::comes_true;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

class Live : public cli::scratch {
 protected:
  /// How much of it is there.
  static std::uintmax_t size_of(const std::string& name) {
    std::error_code none;
    const std::uintmax_t size = fs::file_size(name, none);
    return none ? 0 : size;
  }
};

TEST_F(Live, Count_EndsIt) {
  const outcome done = run({"dump", "sim:?seed=3", "-n", "2500", "-f", "csv", "--fov", "10:350"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(lines_of(done.out).size(), 2501U);
  EXPECT_THAT(done.out, StartsWith("scan,angle_deg,range_mm,time_ns\n"));
  EXPECT_THAT(done.err, HasSubstr("samples lost"));
}

TEST_F(Live, TimesAreOfTheWallClockByDefault) {
  const std::time_t before = std::time(nullptr);
  const outcome done = run({"sim:", "-n", "100", "-f", "csv", "-q"});
  EXPECT_EQ(done.err, "");
  const std::vector<std::string> lines = lines_of(done.out);
  ASSERT_EQ(lines.size(), 101U);
  const auto time_of = [](const std::string& line) {
    return std::stoll(line.substr(line.rfind(',') + 1));
  };
  EXPECT_GE(time_of(lines[1]), (before - 1) * 1'000'000'000LL);
  EXPECT_LE(time_of(lines[100]), (std::time(nullptr) + 1) * 1'000'000'000LL);
  const std::vector<std::string> from_zero =
      lines_of(run({"sim:", "-n", "3", "-f", "csv", "-q", "--time", "zero"}).out);
  EXPECT_EQ(time_of(from_zero.at(1)), 0);
  EXPECT_LT(time_of(from_zero.at(3)), 1'000'000'000);
}

// The duration is counted from the start command on; points come when the head has spun up.
TEST_F(Live, Duration_EndsIt) {
  const auto begin = std::chrono::steady_clock::now();
  const outcome done = run({"dump", "sim:", "-d", "2500ms", "-f", "csv", "-q"});
  const auto took = std::chrono::steady_clock::now() - begin;
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_GE(took, 2500ms);
  const std::vector<std::string> lines = lines_of(done.out);
  ASSERT_GT(lines.size(), 1000U);
  const auto time_of = [](const std::string& line) {
    return std::stoll(line.substr(line.rfind(',') + 1));
  };
  const auto span_ns = static_cast<double>(time_of(lines.back()) - time_of(lines[1]));
  EXPECT_LE(span_ns, 2.6e9) << "points from behind the end";
  // At most every sample from the first to the last one, 9,000 a second: a busy machine loses some.
  EXPECT_LE(static_cast<double>(lines.size() - 2), span_ns * 9e-6 * 1.01);
}

TEST_F(Live, Interrupted_PrintsTheCounts) {
  program started({"dump", "sim:", "-f", "csv"});
  started.read_until("\n0,");
  started.send(SIGINT);
  const outcome done = started.wait();
  EXPECT_EQ(done.code, 130);
  EXPECT_THAT(done.err, HasSubstr(" points in "));
  EXPECT_THAT(done.err, HasSubstr(" samples lost, "));
  EXPECT_THAT(done.err, HasSubstr(" missed, "));
  EXPECT_EQ(done.out.back(), '\n');
}

TEST_F(Live, File_GrowsAndIsValidAfterAKill) {
  const std::string out = path("out.csv");
  cli::write_file(out, "older\n");
  program started({"dump", "sim:", "-f", "csv", "-o", out, "-q", "--force"});
  ASSERT_TRUE(comes_true([&] { return size_of(out) > 1000; }));
  EXPECT_EQ(listing(), "out.csv\n");
  started.send(SIGKILL);
  started.wait();
  EXPECT_THAT(cli::read_file(out), StartsWith("scan,angle_deg,range_mm,time_ns\n"));
}

TEST_F(Live, Loss_EndsItByDefault) {
  cli::simulator simulator(path("lidar"));
  program started({"dump", path("lidar"), "-f", "csv", "-o", path("out.csv")});
  ASSERT_TRUE(comes_true([&] { return size_of(path("out.csv")) > 10'000; }));
  static_cast<void>(simulator.log());  // ends it: the port is gone
  const outcome done = started.wait();
  EXPECT_EQ(done.code, 9) << done.err;
  EXPECT_THAT(lines_of(done.err).back(), StartsWith("g4-dump: "));
  EXPECT_THAT(done.err, HasSubstr(" points in "));
  const std::string kept = cli::read_file(path("out.csv"));
  EXPECT_GT(lines_of(kept).size(), 100U);
  EXPECT_EQ(kept.back(), '\n');
}

TEST_F(Live, Reconnect_Continues) {
  auto simulator = std::make_unique<cli::simulator>(path("lidar"));
  const std::string out = path("out.csv");
  program started({"dump", path("lidar"), "-f", "csv", "--on-loss", "reconnect", "-o", out});
  ASSERT_TRUE(comes_true([&] { return size_of(out) > 10'000; }));
  static_cast<void>(simulator->log());  // ends it: the port is gone
  ASSERT_FALSE(fs::exists(path("lidar")));
  const std::uintmax_t before = size_of(out);
  simulator = std::make_unique<cli::simulator>(path("lidar"));
  ASSERT_TRUE(comes_true([&] { return size_of(out) > before + 200'000; })) << "it does not go on";
  started.send(SIGINT);
  const outcome done = started.wait();
  EXPECT_EQ(done.code, 130) << done.err;
  EXPECT_THAT(done.err, HasSubstr(": lost, "));
  EXPECT_THAT(done.err, HasSubstr(": reconnected\n"));
  EXPECT_THAT(done.err, HasSubstr(" 1 reconnect\n"));
}

TEST_F(Live, Wait_WaitsForAMissingDevice) {
  program started({"dump", path("lidar"), "-n", "50", "-f", "csv", "--on-loss", "wait"});
  std::this_thread::sleep_for(300ms);
  program simulator({"sim", "--link", path("lidar")});
  const outcome done = started.wait();
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(lines_of(done.out).size(), 51U);
  program never({"dump", path("none"), "--on-loss", "wait"});
  ASSERT_TRUE(comes_true([&] { return never.handles(SIGTERM); }));
  never.send(SIGTERM);
  EXPECT_EQ(never.wait().code, 128 + SIGTERM);
}

TEST_F(Live, ClosedPipe_IsDetectedWhenNothingIsWritten) {
  program started({"dump", "sim:", "--range", "99:100"});
  started.read_until("time_s\n");
  started.close_output();
  EXPECT_EQ(started.wait().code, 0);
}

}  // namespace
