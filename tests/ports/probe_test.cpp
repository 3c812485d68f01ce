// SPDX-License-Identifier: MIT
// Who answers, and who does not.
#include <atomic>
#include <thread>

#include "g4lidar/discovery.hpp"
#include "g4lidar/serial_port.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "lives.hpp"
#include "pty.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
using sim::fault_kind;

result<device_information> probe_at(const std::string& path, std::chrono::milliseconds time = 20s) {
  auto port = serial_port::open(path);
  if (!port) return tl::unexpected(port.error());
  return probe(**port, in(**port, time));
}

result<device_information> probe_device(const sim::device_options& options,
                                        std::vector<sim::fault> faults = {},
                                        std::chrono::milliseconds time = 20s) {
  auto served = sim::background_pty::open(sim::device(sim::built_in_world(), options, faults));
  if (!served) return tl::unexpected(served.error());
  return probe_at(served->path(), time);
}

TEST(Probe, G4_SaysItsNumber) {
  const auto found = probe_device({});
  ASSERT_TRUE(found) << found.error().message();
  EXPECT_EQ(*found, sim::device_options{}.info);
}

TEST(Probe, G4_IsLeftIdle) {
  auto served = sim::background_pty::open(
      sim::device(sim::built_in_world(), {}, std::vector{sim::make_fault(fault_kind::scanning)}));
  ASSERT_TRUE(served);
  const auto found = probe_at(served->path());
  ASSERT_TRUE(found) << found.error().message();
  EXPECT_EQ(found->serial_number(), "2021101000070073");
  served->with([](sim::device& twin, std::int64_t) { EXPECT_FALSE(twin.is_scanning()); });
}

TEST(Probe, OnlyStopsAndQuestionsAreSent) {
  auto served = sim::background_pty::open(sim::device(sim::built_in_world()));
  ASSERT_TRUE(served);
  ASSERT_TRUE(probe_at(served->path()));
  served->with([](sim::device& twin, std::int64_t) {
    EXPECT_FALSE(twin.log().empty());
    for (const sim::asked& one : twin.log()) {
      EXPECT_TRUE(one.code == 0x00 || one.code == 0x65 || one.code == 0x90) << int{one.code};
    }
  });
}

TEST(Probe, OtherDevice_SaysItsModel) {
  sim::device_options other;
  other.info.model = 4;
  const auto found = probe_device(other);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().what(), problem::other_device);
  EXPECT_TRUE(found.error().subject().ends_with(", model 4"));
}

TEST(Probe, NobodyAnswers_Silence) {
  const auto found = probe_device({}, {sim::make_fault(fault_kind::deaf)});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().what(), problem::silence);
  EXPECT_EQ(found.error().doing(), task::asking);
}

TEST(Probe, ScansAndHearsNothing_DoesNotStop) {
  const auto found =
      probe_device({}, {sim::make_fault(fault_kind::scanning), sim::make_fault(fault_kind::deaf)});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().what(), problem::does_not_stop);
}

TEST(Probe, WrongBaudRate_Garbage) {
  const auto found =
      probe_device({}, {sim::make_fault(fault_kind::scanning), sim::make_fault(fault_kind::baud)});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().what(), problem::garbage);
}

TEST(Probe, AnotherKindOfDevice_Garbage) {
  const pty device;
  std::atomic<bool> done = false;
  std::thread gps([&] {
    while (!done) {
      device.send("$GPGGA,092750.000,5321.6802,N,00630.3372,W,1,8,1.03,61.7,M,55.2,M,,*76\r\n");
      std::this_thread::sleep_for(10ms);
    }
  });
  const auto found = probe_at(device.path(), 3s);
  done = true;
  gps.join();
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().what(), problem::garbage);
}

TEST(Probe, DeadlinesAreKept) {
  const pty device;
  auto port = serial_port::open(device.path());
  ASSERT_TRUE(port);
  const std::int64_t deadline_ns = in(**port, 20ms);
  EXPECT_EQ(probe(**port, deadline_ns).error().what(), problem::silence);
  EXPECT_LT((*port)->now_ns(), deadline_ns + std::chrono::nanoseconds(5s).count());
}

TEST(Probe, Unplugged_Gone) {
  pty device;
  auto port = serial_port::open(device.path());
  ASSERT_TRUE(port);
  device.unplug();
  EXPECT_EQ(probe(**port, in(**port, 20s)).error().what(), problem::gone);
}

TEST(Probe, Woken_Cancelled) {
  const pty device;
  auto port = serial_port::open(device.path());
  ASSERT_TRUE(port);
  (*port)->wake();
  EXPECT_EQ(probe(**port, in(**port, 20s)).error().what(), problem::cancelled);
}

TEST(SelectPort, Path_IsTakenAsItIs) {
  const auto port = select_port("/dev/no-such-port");
  ASSERT_TRUE(port);
  EXPECT_EQ(port->path, "/dev/no-such-port");
}

TEST(SelectPort, WrongForms_AreRefused) {
  for (const std::string_view wrong :
       {"serial:", "serial:123", "serial:20211010000700733", "serial:202110100007007x", "usb:"}) {
    const auto port = select_port(wrong);
    ASSERT_FALSE(port) << wrong;
    EXPECT_EQ(port.error().what(), problem::bad_option) << wrong;
    EXPECT_TRUE(port.error().subject().starts_with(wrong)) << port.error().subject();
  }
}

}  // namespace
}  // namespace g4lidar::test
