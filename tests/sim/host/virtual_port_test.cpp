// SPDX-License-Identifier: MIT
// The simulated G4 as a transport in virtual time: deadlines, unplugging, waking, reconnecting.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

#include "g4lidar/sim/virtual_port.hpp"
#include "support/host_side.hpp"

namespace {

using namespace g4lidar;
using sim::fault_kind;
using sim::make_fault;
using test::ms;
using test::second;

constexpr std::array<std::uint8_t, 2> start{0xA5, 0x60};
constexpr std::array<std::uint8_t, 2> ask_info{0xA5, 0x90};

class SimVirtualPort : public testing::Test {
 protected:
  static sim::device with(std::initializer_list<sim::fault> faults) {
    return sim::device(sim::built_in_world(), {}, std::span(faults.begin(), faults.size()));
  }
  std::array<std::uint8_t, 512> buffer_{};
  sim::virtual_clock clock_{0};
};

TEST_F(SimVirtualPort, Read_EndsAtTheDeadline) {
  sim::device simulated = with({});
  sim::virtual_port port(simulated, clock_);
  const auto nothing = port.read(buffer_, 30 * ms);
  ASSERT_TRUE(nothing);
  EXPECT_EQ(nothing->count, 0U);
  EXPECT_EQ(port.now_ns(), 30 * ms);
  ASSERT_TRUE(port.write(ask_info, second));
  std::size_t count = 0;
  while (count < 27) {
    const auto got = port.read(buffer_, second);
    ASSERT_TRUE(got);
    ASSERT_GT(got->count, 0U);
    EXPECT_EQ(got->arrival_ns, port.now_ns());
    count += got->count;
  }
  // 2 bytes to the device, 1 ms of reaction, 27 bytes back, and at most 1 ms in the bridge.
  const std::int64_t wire_ns = 29 * 10 * second / 230'400;
  EXPECT_GE(port.now_ns(), 31 * ms + wire_ns);
  EXPECT_LE(port.now_ns(), 32 * ms + wire_ns + ms / 100);
}

TEST_F(SimVirtualPort, Pause_IsNotEndedByBytes) {
  sim::device simulated = with({});
  sim::virtual_port port(simulated, clock_);
  ASSERT_TRUE(port.write(start, second));
  ASSERT_TRUE(port.pause(100 * ms));
  EXPECT_EQ(port.now_ns(), 100 * ms);
  const auto got = port.read(buffer_, 100 * ms);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->count, buffer_.size());
}

TEST_F(SimVirtualPort, Unplugged_IsGoneForEver) {
  sim::device simulated = with({make_fault(fault_kind::unplug, second, second)});
  sim::virtual_port port(simulated, clock_);
  const auto read = port.read(buffer_, 10 * second);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code(), problem::gone);
  EXPECT_EQ(read.error().doing(), task::reading);
  EXPECT_EQ(port.now_ns(), second) << "reported immediately";
  clock_.advance_to(3 * second);  // it is plugged in again, but this is the old port
  const auto write = port.write(ask_info, 10 * second);
  ASSERT_FALSE(write);
  EXPECT_EQ(write.error().code(), problem::gone);
  EXPECT_EQ(write.error().doing(), task::writing);
}

TEST_F(SimVirtualPort, Unplug_EndsAPause) {
  sim::device simulated = with({make_fault(fault_kind::unplug, second)});
  sim::virtual_port port(simulated, clock_);
  const auto paused = port.pause(10 * second);
  ASSERT_FALSE(paused);
  EXPECT_EQ(paused.error().code(), problem::gone);
  EXPECT_EQ(port.now_ns(), second);
}

TEST_F(SimVirtualPort, WakesOnce) {
  sim::device simulated = with({});
  sim::virtual_port port(simulated, clock_);
  port.wake();
  const auto woken = port.read(buffer_, second);
  ASSERT_FALSE(woken);
  EXPECT_EQ(woken.error().code(), problem::cancelled);
  EXPECT_EQ(port.now_ns(), 0);
  EXPECT_TRUE(port.read(buffer_, second));
}

TEST_F(SimVirtualPort, BusyLoop_Ends) {
  sim::device simulated = with({});
  sim::virtual_clock ticking;
  sim::virtual_port port(simulated, ticking);
  while (ticking.now_ns() < 10 * ms) (void)port.read(buffer_, 0);
  EXPECT_EQ(ticking.calls(), 10'000U);
}

TEST_F(SimVirtualPort, Connector_FindsPluggedDevices) {
  sim::device simulated = with({make_fault(fault_kind::unplug, second, second)});
  sim::virtual_connector finder(simulated, clock_);
  const auto first = finder.connect();
  ASSERT_TRUE(first);
  clock_.advance_to(second);
  const auto none = finder.connect();
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code(), problem::no_port);
  EXPECT_EQ(none.error().doing(), task::opening);
  EXPECT_TRUE(finder.pause(3 * second));
  EXPECT_EQ(finder.now_ns(), 3 * second);
  const auto again = finder.connect();
  ASSERT_TRUE(again);
  EXPECT_TRUE((*again)->write(ask_info, 4 * second));
  EXPECT_FALSE((*first)->write(ask_info, 4 * second));
  finder.wake();
  EXPECT_FALSE(finder.pause(9 * second));
  EXPECT_EQ(finder.now_ns(), 3 * second);
}

TEST_F(SimVirtualPort, SeveralDevicesAreTriedInTurn) {
  sim::device_options other;
  other.info.serial_digits.fill('7');
  sim::device one = with({});
  sim::device two(sim::built_in_world(), other);
  sim::virtual_connector finder({&one, &two}, clock_);
  std::vector<std::uint8_t> last_digits;
  for (int i = 0; i < 4; ++i) {
    const auto port = finder.connect();
    ASSERT_TRUE(port);
    ASSERT_TRUE((*port)->write(ask_info, clock_.now_ns()));
    ASSERT_TRUE((*port)->pause(clock_.now_ns() + 50 * ms));
    const auto got = (*port)->read(buffer_, clock_.now_ns());
    ASSERT_TRUE(got);
    ASSERT_EQ(got->count, 27U);
    last_digits.push_back(buffer_[26]);
  }
  EXPECT_EQ(last_digits, (std::vector<std::uint8_t>{3, 7, 3, 7}));
}

}  // namespace
