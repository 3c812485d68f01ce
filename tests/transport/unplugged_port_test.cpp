// SPDX-License-Identifier: MIT
// A serial port that is unplugged, replaced by a pseudo-terminal.
#include "g4lidar/transport/serial_port.hpp"

#include <atomic>
#include <chrono>
#include <thread>

#include "port_io.hpp"
#include "pty.hpp"
#include "support/patience.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

TEST(SerialPort, UnpluggedDuringAWait_IsGoneImmediately) {
  using step = result<void> (*)(transport&);
  const step waits[] = {
      [](transport& port) -> result<void> {
        std::array<std::uint8_t, 16> buffer{};
        const auto got = port.read(buffer, in(port, 10 * patience));
        return got ? result<void>{} : tl::unexpected(got.error());
      },
      [](transport& port) -> result<void> { return port.pause(in(port, 10 * patience)); },
  };
  for (const step wait : waits) {
    pty device;
    const auto port = opened(device);
    std::atomic<std::int64_t> unplugged_ns = 0;
    std::thread hand([&] {
      std::this_thread::sleep_for(20ms);
      unplugged_ns = port->now_ns();
      device.unplug();
    });
    const auto waited = wait(*port);
    const std::int64_t reported_ns = port->now_ns();
    hand.join();
    ASSERT_FALSE(waited);
    EXPECT_EQ(waited.error().code(), problem::gone);
    EXPECT_TRUE(waited.error().is_fatal());
    // The promise is 0.1 s; a loaded machine may need time to run this thread.
    EXPECT_LT(reported_ns - unplugged_ns, std::chrono::nanoseconds(patience).count());
  }
}

TEST(SerialPort, Unplugged_EveryCallIsGone) {
  pty device;
  const auto port = opened(device);
  device.unplug();
  std::array<std::uint8_t, 16> buffer{};
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(port->read(buffer, in(*port, patience)).error().code(), problem::gone);
    EXPECT_EQ(port->read(buffer, port->now_ns()).error().code(), problem::gone);
    EXPECT_EQ(write_text(*port, "x").error().code(), problem::gone);
    EXPECT_EQ(port->pause(in(*port, patience)).error().code(), problem::gone);
    EXPECT_EQ(port->set_baud(115'200).error().code(), problem::gone);
    EXPECT_EQ(port->set_baud(128'000).error().code(), problem::gone);
  }
}

}  // namespace
}  // namespace g4lidar::test
