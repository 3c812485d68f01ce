// SPDX-License-Identifier: MIT
// The examples that need a G4, as a user runs them, with a simulated one.
#include <gtest/gtest.h>

#include <csignal>
#include <regex>
#include <string>

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
    const std::regex line(R"( +\d+: \d+ points at \d+\.\d\d Hz, the nearest 0\.\d+ m away, )"
                          R"([+-]\d\.\d\d rad from ahead\n)");
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
