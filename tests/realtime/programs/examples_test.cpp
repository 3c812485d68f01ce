// SPDX-License-Identifier: MIT
// The examples that need a G4, as a user runs them, with a simulated one.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "g4lidar/sim/scanner.hpp"
#include "g4lidar/sim/world.hpp"

#include "realtime/child_process.hpp"
#include "realtime/device_on_pty.hpp"

namespace g4lidar {
namespace {

using test::child_process;
using test::device_on_pty;
using test::scratch_directory;

TEST(LiveScan, PrintsALineForEachScanUntilASignal) {
  for (const int signal : {SIGINT, SIGTERM}) {
    scratch_directory directory;
    device_on_pty simulated;
    child_process program({EXAMPLE_LIVE_SCAN, simulated.path()}, directory.file("output"));
    ASSERT_TRUE(program.prints("  5: ")) << program.output();
    program.send(signal);
    EXPECT_EQ(program.wait(), 0);
    EXPECT_TRUE(simulated.becomes_idle_and_silent());
    const std::string output = program.output();
    const std::regex line(
        R"( +\d+: \d+ points at \d+\.\d\d Hz, the nearest 0\.\d+ m away, )"
        R"([+-]\d\.\d\d rad from ahead(, perhaps something nearer in \d+ samples)?\n)");
    const auto end = std::sregex_iterator();
    EXPECT_GE(std::distance(std::sregex_iterator(output.begin(), output.end(), line), end), 3)
        << output;
    EXPECT_EQ(std::regex_replace(output, line, ""), "");
  }
}

TEST(LiveScan, PrintsNoRangeWithoutAReturn) {
  scratch_directory directory;
  sim::device_options options = test::quick_g4();
  options.scanner.dropout_ratio = 1.0;
  device_on_pty simulated(options);
  child_process program({EXAMPLE_LIVE_SCAN, simulated.path()}, directory.file("output"));
  ASSERT_TRUE(program.prints("  3: ")) << program.output();
  program.send(SIGINT);
  EXPECT_EQ(program.wait(), 0);
  const std::regex line(R"(( +\d+: \d+ points at \d+\.\d\d Hz, no return\n)+)");
  EXPECT_TRUE(std::regex_match(program.output(), line)) << program.output();
}

/// A lidar that drives to 0.15 m before a wall and stays there.
TEST(LiveScan, AWallThatIsTooNearForAReturn_IsStillReported) {
  scratch_directory directory;
  const auto world = sim::parse_world(
      "wall -4 -3 4 -3\nwall 4 -3 4 3\nwall 4 3 -4 3\nwall -4 3 -4 -3\n"
      "lidar 3.2 0 0\ndrive wait 2\ndrive forward 0.65 0.3\n");
  ASSERT_TRUE(std::holds_alternative<sim::world>(world));
  sim::scanner lidar(std::get<sim::world>(world), {});
  std::ofstream file(directory.file("wall.bin"), std::ios::binary);
  for (std::int64_t now_ns = 0; now_ns < 8'000'000'000;) {
    const sim::sent_packet sent = lidar.next();
    file.write(reinterpret_cast<const char*>(sent.data.data()),
               static_cast<std::streamsize>(sent.data.size()));
    now_ns = sent.complete_ns;
  }
  file.close();
  child_process program({EXAMPLE_LIVE_SCAN, "file:" + directory.file("wall.bin")},
                        directory.file("output"));
  EXPECT_EQ(program.wait(), 1) << "the end of the file";
  std::vector<std::string> lines;
  std::istringstream output(program.output());
  for (std::string line; std::getline(output, line);) {
    if (line.find(" points at ") != std::string::npos) lines.push_back(line);
  }
  ASSERT_GE(lines.size(), 50U) << program.output();
  const auto is_reported = [](const std::string& line) {
    return line.find("perhaps something nearer in ") != std::string::npos;
  };
  EXPECT_TRUE(std::none_of(lines.begin(), lines.begin() + 10, is_reported)) << "0.8 m away";
  // It stands from 4.5 s on: its last 20 revolutions, far more than those of the last near return.
  EXPECT_TRUE(std::all_of(lines.end() - 20, lines.end(), is_reported)) << program.output();
}

TEST(LiveScan, PrintsTheError) {
  scratch_directory directory;
  child_process program({EXAMPLE_LIVE_SCAN, directory.file("nothing")}, directory.file("output"));
  EXPECT_EQ(program.wait(), 1);
  EXPECT_NE(program.output().find("nothing"), std::string::npos) << program.output();
}

TEST(LiveScan, EndsWhenTheDeviceIsUnplugged) {
  scratch_directory directory;
  device_on_pty simulated;
  child_process program({EXAMPLE_LIVE_SCAN, simulated.path()}, directory.file("output"));
  ASSERT_TRUE(program.prints("  3: ")) << program.output();
  simulated.unplug();
  EXPECT_EQ(program.wait(), 1);
}

TEST(EventLoop, ContinuesAfterAnUnplugAndStopsTheMotorAtTheEnd) {
  scratch_directory directory;
  device_on_pty simulated;
  child_process program({EXAMPLE_EVENT_LOOP, simulated.path()}, directory.file("output"));
  ASSERT_TRUE(program.prints("scan 3: ")) << program.output();
  simulated.unplug();
  ASSERT_TRUE(program.prints("lost\n")) << program.output();
  simulated.replug();
  ASSERT_TRUE(program.prints("reconnected\nscan ")) << program.output();
  program.send(SIGTERM);
  EXPECT_EQ(program.wait(), 0);
  EXPECT_TRUE(simulated.becomes_idle_and_silent());
}

}  // namespace
}  // namespace g4lidar
