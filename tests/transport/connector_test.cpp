// SPDX-License-Identifier: MIT
// The transport for a name and options; settings that another process has changed.
#include <gtest/gtest.h>

#include "discovery/system_connector.hpp"
#include "g4lidar/transport/serial_port.hpp"
#include "listener.hpp"
#include "other_container.hpp"
#include "pty.hpp"
#include "transport/port_holder.hpp"

namespace g4lidar {
namespace {

TEST(Connector, Bridge_HasTheBaudRateOfTheOptions) {
  test::listener bridge;
  const auto connector = system_connector::make("tcp:" + bridge.address(), 115'200);
  ASSERT_TRUE(connector);
  const auto opened = (*connector)->connect();
  ASSERT_TRUE(opened) << opened.error().message();
  EXPECT_EQ((*opened)->baud(), 115'200U);
}

/// The error for a timeout on a port that was opened at `baud`, and then set to `now` by another
/// process.
problem reported_after_change(std::uint32_t baud, speed_t now) {
  const test::pty port;
  const auto opened = serial_port::open(port.path(), {.baud = baud});
  if (!opened) return opened.error().code();
  termios settings{};
  EXPECT_EQ(::tcgetattr(port.keep(), &settings), 0);
  ::cfsetspeed(&settings, now);
  EXPECT_EQ(::tcsetattr(port.keep(), TCSANOW, &settings), 0);
  return with_port_conflict(error(task::asking, problem::timeout), **opened).code();
}

TEST(Connector, ChangedBaudRate_IsDetectedAtAnyRate) {
  EXPECT_EQ(reported_after_change(230'400, B230400), problem::timeout);
  EXPECT_EQ(reported_after_change(230'400, B9600), problem::interference);
  EXPECT_EQ(reported_after_change(115'200, B115200), problem::timeout);
  EXPECT_EQ(reported_after_change(115'200, B230400), problem::interference);
  EXPECT_EQ(reported_after_change(250'000, B38400), problem::interference);
}

TEST(Connector, APtyOfAnotherContainer_WithTheSameNumber_IsNotTheSamePort) {
  const test::pty port;
  const test::other_container other(port.path());
  if (!other.is_open()) GTEST_SKIP() << "no mount namespaces here";
  EXPECT_EQ(port_conflict(port.path()), "");
}

}  // namespace
}  // namespace g4lidar
