// SPDX-License-Identifier: MIT
// The transport for a name and options; settings that another process has changed.
#include <gtest/gtest.h>

#include "discovery/system_connector.hpp"
#include "driver/port_conflict.hpp"
#include "g4lidar/transport/serial_port.hpp"
#include "listener.hpp"
#include "pty.hpp"

namespace g4lidar {
namespace {

TEST(Connector, Bridge_HasTheBaudRateOfTheOptions) {
  test::listener bridge;
  const auto connector = system_connector::make("tcp:" + bridge.address(), 115'200);
  ASSERT_TRUE(connector);
  const auto line = (*connector)->connect();
  ASSERT_TRUE(line) << line.error().message();
  EXPECT_EQ((*line)->baud(), 115'200U);
}

/// The error for a timeout on a port that was opened at `baud`, and then set to `now` by another
/// process.
problem told_after_change(std::uint32_t baud, speed_t now) {
  const test::pty port;
  const auto line = serial_port::open(port.path(), {.baud = baud});
  if (!line) return line.error().code();
  termios settings{};
  EXPECT_EQ(::tcgetattr(port.keep(), &settings), 0);
  ::cfsetspeed(&settings, now);
  EXPECT_EQ(::tcsetattr(port.keep(), TCSANOW, &settings), 0);
  return with_port_conflict(error(task::asking, problem::timeout), **line).code();
}

TEST(Connector, ChangedBaudRate_IsDetectedAtAnyRate) {
  EXPECT_EQ(told_after_change(230'400, B230400), problem::timeout);
  EXPECT_EQ(told_after_change(230'400, B9600), problem::interference);
  EXPECT_EQ(told_after_change(115'200, B115200), problem::timeout);
  EXPECT_EQ(told_after_change(115'200, B230400), problem::interference);
  EXPECT_EQ(told_after_change(250'000, B38400), problem::interference);
}

}  // namespace
}  // namespace g4lidar
