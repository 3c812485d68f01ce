// SPDX-License-Identifier: MIT
// The examples that need a G4, as a user runs them, with a simulated one.
#include <gtest/gtest.h>

#include <csignal>
#include <regex>
#include <string>

#include "realtime/child_process.hpp"
#include "realtime/twin_on_pty.hpp"

namespace g4lidar {
namespace {

using test::child_process;
using test::scratch_directory;
using test::twin_on_pty;

TEST(LiveScan, PrintsALineForEachScanUntilASignal) {
  for (const int signal : {SIGINT, SIGTERM}) {
    scratch_directory directory;
    twin_on_pty twin;
    child_process program({EXAMPLE_LIVE_SCAN, twin.path()}, directory.file("said"));
    ASSERT_TRUE(program.says("  5: ")) << program.said();
    program.send(signal);
    EXPECT_EQ(program.wait(), 0);
    EXPECT_TRUE(twin.becomes_idle_and_silent());
    const std::string said = program.said();
    const std::regex line(R"( +\d+: \d+ points at \d+\.\d\d Hz, the nearest 0\.\d+ m away, )"
                          R"([+-]\d\.\d\d rad from ahead\n)");
    const auto end = std::sregex_iterator();
    EXPECT_GE(std::distance(std::sregex_iterator(said.begin(), said.end(), line), end), 3) << said;
    EXPECT_EQ(std::regex_replace(said, line, ""), "");
  }
}

TEST(LiveScan, PrintsTheError) {
  scratch_directory directory;
  child_process program({EXAMPLE_LIVE_SCAN, directory.file("nothing")}, directory.file("said"));
  EXPECT_EQ(program.wait(), 1);
  EXPECT_NE(program.said().find("nothing"), std::string::npos) << program.said();
}

TEST(LiveScan, EndsWhenTheDeviceIsUnplugged) {
  scratch_directory directory;
  twin_on_pty twin;
  child_process program({EXAMPLE_LIVE_SCAN, twin.path()}, directory.file("said"));
  ASSERT_TRUE(program.says("  3: ")) << program.said();
  twin.unplug();
  EXPECT_EQ(program.wait(), 1);
}

TEST(EventLoop, ContinuesAfterAnUnplugAndStopsTheMotorAtTheEnd) {
  scratch_directory directory;
  twin_on_pty twin;
  child_process program({EXAMPLE_EVENT_LOOP, twin.path()}, directory.file("said"));
  ASSERT_TRUE(program.says("scan 3: ")) << program.said();
  twin.unplug();
  ASSERT_TRUE(program.says("lost\n")) << program.said();
  twin.replug();
  ASSERT_TRUE(program.says("reconnected\nscan ")) << program.said();
  program.send(SIGTERM);
  EXPECT_EQ(program.wait(), 0);
  EXPECT_TRUE(twin.becomes_idle_and_silent());
}

}  // namespace
}  // namespace g4lidar
