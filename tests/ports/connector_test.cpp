// SPDX-License-Identifier: MIT
// Lines by their names, and what the options say of them; settings that somebody has changed.
#include <gtest/gtest.h>

#include "device/rival.hpp"
#include "device/system_connector.hpp"
#include "g4lidar/serial_port.hpp"
#include "listener.hpp"
#include "pty.hpp"

namespace g4lidar {
namespace {

TEST(Connector, ABridgeHasTheBaudRateOfTheOptions) {
  test::listener bridge;
  const auto connector = system_connector::make("tcp:" + bridge.address(), 115'200);
  ASSERT_TRUE(connector);
  const auto line = (*connector)->connect();
  ASSERT_TRUE(line) << line.error().message();
  EXPECT_EQ((*line)->baud(), 115'200U);
}

/// What a timeout on a port is told as that was opened at `baud`, and then set to `now` by somebody.
problem told_after_change(std::uint32_t baud, speed_t now) {
  const test::pty port;
  const auto line = serial_port::open(port.path(), {.baud = baud});
  if (!line) return line.error().what();
  termios settings{};
  EXPECT_EQ(::tcgetattr(port.keep(), &settings), 0);
  ::cfsetspeed(&settings, now);
  EXPECT_EQ(::tcsetattr(port.keep(), TCSANOW, &settings), 0);
  return with_rivals(error(task::asking, problem::timeout), **line).what();
}

TEST(Connector, AChangedBaudRateIsSeenAtAnyRate) {
  EXPECT_EQ(told_after_change(230'400, B230400), problem::timeout);
  EXPECT_EQ(told_after_change(230'400, B9600), problem::interference);
  EXPECT_EQ(told_after_change(115'200, B115200), problem::timeout);
  EXPECT_EQ(told_after_change(115'200, B230400), problem::interference);
  EXPECT_EQ(told_after_change(250'000, B38400), problem::interference);
}

}  // namespace
}  // namespace g4lidar
