// SPDX-License-Identifier: MIT
// The times of g4-dump: when it begins to write, how long a replay takes, what a kill loses. Skipped where the
// machine was stopped.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "cli/program.hpp"
#include "cli/recorded.hpp"
#include "cli/recording.hpp"
#include "support/machine_watch.hpp"
#include "support/patience.hpp"

namespace {

using namespace std::chrono_literals;
using cli::points_of;
using cli::run;
using g4lidar::test::machine_was_stopped;
using g4lidar::test::machine_watch;
using g4lidar::test::percentile_of;
using clock = std::chrono::steady_clock;

class ToolTimes : public cli::scratch {
 protected:
  machine_watch machine_;
};

/// From its start to its first line.
std::chrono::nanoseconds time_to_first_line(const std::vector<std::string>& arguments) {
  const auto begin = clock::now();
  cli::program started(arguments);
  started.read_until("\n");
  const auto took = clock::now() - begin;
  started.close_output();
  EXPECT_EQ(started.wait().code, 0);
  return took;
}

// The first line of a long file comes before a fortieth of the time that all of it takes: the median of 21 runs,
// each less the time that the program takes to start.
TEST_F(ToolTimes, LongDump_BeginsImmediately) {
  cli::write_repeated(path("long.bin"), cli::zero(0) + cli::turn(), 20'000'000);
  const std::vector<std::string> dump{"dump", path("long.bin"), "-q", "-f", "csv"};
  const auto begin = clock::now();
  EXPECT_EQ(cli::program(dump, {{}, cli::stream::of_file("/dev/null"), {}}).wait().code, 0);
  const std::chrono::nanoseconds whole = clock::now() - begin;
  std::vector<std::chrono::nanoseconds> later;
  for (int i = 0; i < 21; ++i) {
    const auto start = time_to_first_line({"--version"});
    later.push_back(time_to_first_line(dump) - start);
  }
  const auto median = percentile_of(50, later);
  if (median > whole / 40 && machine_.was_stopped()) GTEST_SKIP() << machine_was_stopped;
  EXPECT_LE(median, whole / 40);
}

TEST_F(ToolTimes, Replay_TakesAsLongAsItTook) {
  ASSERT_EQ(cli::record_scans(path("walk.mcap"), 7).code, 0);
  const std::vector<std::string> points = points_of(path("walk.mcap"));
  const double recorded_s =
      static_cast<double>(cli::number_in(points.back(), 3) - cli::number_in(points.at(1), 3)) / 1e9;
  ASSERT_GT(recorded_s, 0.8);
  const auto median_s = [&](const std::string& speed) {
    std::vector<std::chrono::nanoseconds> runs;
    for (int i = 0; i < 3; ++i) {
      const auto begin = clock::now();
      EXPECT_EQ(run({"replay", path("walk.mcap"), "--playback-speed", speed, "--scans"}).code, 0);
      runs.emplace_back(clock::now() - begin);
    }
    return std::chrono::duration<double>(percentile_of(50, runs)).count();
  };
  const double overhead_s = median_s("max");  // to start, to read the file, to end
  for (const double speed : {2.0, 1.0}) {
    const double took_s = median_s(std::to_string(speed));
    EXPECT_GE(took_s, recorded_s / speed);
    // What was recorded before the first point is played, too.
    const double most_s = (recorded_s + 0.3) / speed + overhead_s + 0.3;
    if (took_s > most_s && machine_.was_stopped()) GTEST_SKIP() << machine_was_stopped;
    EXPECT_LE(took_s, most_s);
  }
}

// The time between the last point in a file and the moment when its program was killed: the 75th percentile
// of four recordings, side by side.
TEST_F(ToolTimes, KilledRecord_LosesAtMostASecond) {
  std::vector<std::string> names;
  std::vector<std::unique_ptr<cli::program>> started;
  for (const std::string name : {"a.mcap", "b.mcap", "c.mcap", "d.mcap"}) {
    names.push_back(path(name));
    started.push_back(
        std::make_unique<cli::program>(std::vector<std::string>{"record", "sim:", names.back()}));
  }
  for (const std::string& name : names) {
    ASSERT_TRUE(g4lidar::test::comes_true([&] { return points_of(name).size() > 1; }));
  }
  std::this_thread::sleep_for(1s);  // any moment
  std::vector<std::chrono::nanoseconds> lost;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::chrono::nanoseconds killed = clock::now().time_since_epoch();
    started[i]->send(SIGKILL);
    EXPECT_EQ(started[i]->wait().signal, SIGKILL);
    lost.push_back(killed -
                   std::chrono::nanoseconds(cli::number_in(points_of(names[i]).back(), 3)));
    const cli::outcome verified = run({"replay", "--verify", names[i]});
    EXPECT_EQ(verified.code, 10);
    EXPECT_NE(verified.err.find("was cut off"), std::string::npos) << verified.err;
  }
  const auto most = percentile_of(75, lost);
  if (most > 1s && machine_.was_stopped()) GTEST_SKIP() << machine_was_stopped;
  EXPECT_LE(most, 1s);
}

}  // namespace
