// SPDX-License-Identifier: MIT
// Ports are listed, monitored, distinguished and selected. Runs with umockdev preloaded.
#include <gmock/gmock.h>
#include <poll.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/discovery.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "g4lidar/transport/serial_port.hpp"
#include "pty.hpp"
#include "support/machine_watch.hpp"
#include "support/patience.hpp"
#include "testbed.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

class Hotplug : public testing::Test {
 protected:
  void SetUp() override {
    if (!is_preloaded()) GTEST_SKIP() << "umockdev is not preloaded; use umockdev-wrapper";
  }

  [[nodiscard]] static std::vector<std::string> listed() {
    std::vector<std::string> paths;
    const auto ports = list_ports();
    EXPECT_TRUE(ports);
    for (const port_info& port : *ports) paths.push_back(port.path);
    return paths;
  }

  /// The other end of a port, without a device that answers.
  void connect(const bridge& what, const pty& device) const {
    std::filesystem::create_symlink(device.path(), bed.dev(what.name));
  }

  /// A G4 with this number, attached to a port.
  [[nodiscard]] sim::background_pty serve(const bridge& what, char last_digit) const {
    sim::device_options options;
    options.info.serial_digits.back() = last_digit;
    auto served =
        sim::background_pty::open(sim::device(sim::built_in_world(), options), bed.dev(what.name));
    EXPECT_TRUE(served) << served.error().message();
    return *std::move(served);
  }

  testbed bed;
  const bridge first{};
  const bridge second{.name = "ttyUSB1", .place = "1-1.2"};
  const bridge other{
      .name = "ttyUSB2", .place = "2-1", .vendor = "067b", .product = "2303", .driver = "pl2303"};
};

std::string number(char last_digit) { return std::string("serial:202110100007007") + last_digit; }

// ---- listing -----------------------------------------------------------------------------------

TEST_F(Hotplug, NothingPlugged_NothingListed) {
  bed.add_console("tty1");
  bed.add_builtin("ttyS3", "0");
  EXPECT_THAT(listed(), IsEmpty());
}

TEST_F(Hotplug, List_HasTheDataOfSysfs) {
  bed.plug(first);
  const pty device;
  connect(first, device);
  const auto ports = list_ports();
  ASSERT_TRUE(ports);
  ASSERT_EQ(ports->size(), 1U);
  const port_info& port = ports->front();
  EXPECT_EQ(port.path, "/dev/ttyUSB0");
  EXPECT_EQ(port.by_id, "");
  EXPECT_EQ(port.bus_path, "1-1.4");
  EXPECT_EQ(port.usb_serial, "0001");
  EXPECT_EQ(port.manufacturer, "Silicon Labs");
  EXPECT_EQ(port.product, "USB to UART");
  EXPECT_EQ(port.driver, "cp210x");
  EXPECT_EQ(port.vendor_id, 0x10c4);
  EXPECT_EQ(port.product_id, 0xea60);
  EXPECT_TRUE(port.may_open);
  EXPECT_TRUE(is_g4_bridge(port));
}

TEST_F(Hotplug, List_IsOrderedAndIncludesOtherPorts) {
  bed.plug(other);
  bed.plug(second);
  bed.plug(first);
  bed.add_builtin("ttyS0", "4");
  bed.add_builtin("ttyS1", "0");
  bed.add_console("tty1");
  EXPECT_THAT(listed(), ElementsAre("/dev/ttyS0", "/dev/ttyUSB0", "/dev/ttyUSB1", "/dev/ttyUSB2"));
  const auto ports = list_ports();
  EXPECT_FALSE(is_g4_bridge((*ports)[0]));
  EXPECT_EQ((*ports)[0].driver, "serial8250");
  EXPECT_EQ((*ports)[0].bus_path, "");
  EXPECT_FALSE((*ports)[1].may_open) << "there is no node";
  EXPECT_FALSE(is_g4_bridge((*ports)[3]));
}

TEST_F(Hotplug, List_HasTheLinkOfUdevd) {
  bed.plug(first);
  bed.plug(second);
  const pty device;
  connect(first, device);
  std::filesystem::create_directories(bed.dev("serial/by-id"));
  std::filesystem::create_symlink("../../ttyUSB0", bed.dev("serial/by-id/usb-CP2102_0001-port0"));
  const auto ports = list_ports();
  ASSERT_TRUE(ports);
  EXPECT_EQ((*ports)[0].by_id, "/dev/serial/by-id/usb-CP2102_0001-port0");
  EXPECT_EQ((*ports)[1].by_id, "");
}

// ---- watching ----------------------------------------------------------------------------------

/// The next event, which arrives within ten seconds or never.
std::optional<port_event> awaited(port_monitor& monitor) {
  pollfd polled{monitor.native_handle(), POLLIN, 0};
  while (::poll(&polled, 1, patience_ms) > 0) {
    if (auto event = monitor.next()) return event;
  }
  return std::nullopt;
}

TEST_F(Hotplug, Monitor_ReportsPortsThatAppearAndDisappear) {
  bed.plug(first);
  auto monitor = port_monitor::open();
  ASSERT_TRUE(monitor) << monitor.error().message();
  EXPECT_FALSE(monitor->next()) << "it was there before";
  bed.plug(second);
  auto event = awaited(*monitor);
  ASSERT_TRUE(event);
  EXPECT_TRUE(event->plugged);
  EXPECT_EQ(event->port.path, "/dev/ttyUSB1");
  EXPECT_EQ(event->port.bus_path, "1-1.2");
  EXPECT_TRUE(is_g4_bridge(event->port));
  bed.unplug(first);
  event = awaited(*monitor);
  ASSERT_TRUE(event);
  EXPECT_FALSE(event->plugged);
  EXPECT_EQ(event->port.path, "/dev/ttyUSB0");
  EXPECT_EQ(event->port.bus_path, "1-1.4") << "as it was last known";
  EXPECT_FALSE(monitor->next());
}

TEST_F(Hotplug, HundredReplugs_EachIsReportedOnce) {
  auto opened = port_monitor::open();
  ASSERT_TRUE(opened);
  port_monitor monitor = *std::move(opened);
  bridge wandering = first;
  for (int i = 0; i < 100; ++i) {
    wandering.name = "ttyUSB" + std::to_string(i % 3);
    wandering.place = "1-" + std::to_string(i % 4 + 1);
    bed.plug(wandering);
    auto event = awaited(monitor);
    ASSERT_TRUE(event && event->plugged);
    ASSERT_EQ(event->port.path, "/dev/" + wandering.name);
    ASSERT_EQ(select_port("usb:" + wandering.place)->path, "/dev/" + wandering.name);
    ASSERT_THAT(listed(), ElementsAre("/dev/" + wandering.name));
    bed.unplug(wandering);
    event = awaited(monitor);
    ASSERT_TRUE(event && !event->plugged);
    ASSERT_EQ(event->port.bus_path, wandering.place);
    ASSERT_FALSE(monitor.next());
    ASSERT_THAT(listed(), IsEmpty());
  }
}

// ---- selecting ---------------------------------------------------------------------------------

TEST_F(Hotplug, ByUsbPlace) {
  bed.plug(first);
  bed.plug(second);
  EXPECT_EQ(select_port("usb:1-1.2")->path, "/dev/ttyUSB1");
  EXPECT_EQ(select_port("usb:1-1.4")->path, "/dev/ttyUSB0");
  const auto missing = select_port("usb:1-1");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code(), problem::no_port);
  EXPECT_EQ(missing.error().subject(), "usb:1-1");
}

TEST_F(Hotplug, OnlyBridge_IsSelectedWithoutAQuery) {
  bed.plug(first);
  bed.plug(other);
  bed.add_builtin("ttyS0", "4");
  EXPECT_EQ(select_port("")->path,
            "/dev/ttyUSB0");  // the node does not exist, so it cannot be opened
}

TEST_F(Hotplug, NoBridge_NoPort) {
  bed.plug(other);
  EXPECT_EQ(select_port("").error().code(), problem::no_port);
  EXPECT_EQ(select_port(number('1')).error().code(), problem::no_port);
  EXPECT_THAT(*find_lidars(), IsEmpty());
}

TEST_F(Hotplug, TwoG4_AreDistinguishedByTheirNumbers) {
  bed.plug(first);
  bed.plug(second);
  const auto one = serve(first, '1');
  const auto two = serve(second, '2');
  const auto found = find_lidars();
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 2U);
  EXPECT_EQ((*found)[0].port.path, "/dev/ttyUSB0");
  EXPECT_EQ((*found)[0].lidar.device.serial_digits.back(), '1');
  EXPECT_EQ((*found)[1].port.path, "/dev/ttyUSB1");
  EXPECT_EQ((*found)[1].lidar.device.serial_digits.back(), '2');
  EXPECT_EQ(select_port(number('1'))->path, "/dev/ttyUSB0");
  EXPECT_EQ(select_port(number('2'))->path, "/dev/ttyUSB1");
  EXPECT_EQ(select_port(number('3')).error().code(), problem::no_port);
  const auto any = select_port("");
  ASSERT_FALSE(any);
  EXPECT_EQ(any.error().code(), problem::several_ports);
  EXPECT_EQ(any.error().subject(), "/dev/ttyUSB0, /dev/ttyUSB1");
  const std::vector<stage_report> stages = diagnose("");
  EXPECT_THAT(stages.front().diagnoses, ElementsAre(diagnosis::several_ports));
  EXPECT_THAT(stages.front().remark, testing::HasSubstr("/dev/ttyUSB0, /dev/ttyUSB1"));
}

TEST_F(Hotplug, TwoBridgesOneG4_IsSelected) {
  bed.plug(first);
  bed.plug(second);
  const pty silent;
  connect(first, silent);
  const auto two = serve(second, '2');
  EXPECT_EQ(select_port("", {.probe_timeout = 1s})->path, "/dev/ttyUSB1");
}

/// Each port takes its own probe_timeout, although its device never answers. A real-time test, here because it
/// needs umockdev.
TEST_F(Hotplug, SeveralSilentPorts_TakeTheirTimeEach) {
  bed.plug(first);
  bed.plug(second);
  const pty one;
  const pty two;
  connect(first, one);
  connect(second, two);
  const machine_watch machine;
  for (const std::string& which : {std::string(), number('1')}) {
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(select_port(which, {.probe_timeout = 200ms}).error().code(), problem::no_port);
    const auto took = std::chrono::steady_clock::now() - begin;
    EXPECT_GE(took, 2 * 200ms);
    if (took >= 2 * 200ms + 1000ms && machine.was_stopped()) GTEST_SKIP() << machine_was_stopped;
    EXPECT_LT(took, 2 * 200ms + 1000ms) << "a probe without a limit takes 2 s and more";
  }
  EXPECT_EQ(find_options().probe_timeout, 4000ms) << "as in the documentation of lidar::open()";
}

TEST_F(Hotplug, ReplugElsewhere_IsFoundByItsNumber) {
  bed.plug(first);
  {
    const auto one = serve(first, '1');
    EXPECT_EQ(select_port(number('1'))->path, "/dev/ttyUSB0");
  }
  bed.unplug(first);
  EXPECT_EQ(select_port(number('1')).error().code(), problem::no_port);
  bed.plug(second);
  const auto one = serve(second, '1');
  EXPECT_EQ(select_port(number('1'))->bus_path, "1-1.2");
}

TEST_F(Hotplug, BusyG4_CannotBeQueriedAndCounts) {
  bed.plug(first);
  bed.plug(second);
  const auto one = serve(first, '1');
  const auto two = serve(second, '2');
  const auto held = serial_port::open("/dev/ttyUSB1");
  ASSERT_TRUE(held);
  EXPECT_EQ(find_lidars()->size(), 1U);
  EXPECT_EQ(select_port(number('1'))->path, "/dev/ttyUSB0");
  const auto missing = select_port(number('2'));
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code(), problem::busy) << missing.error().message();
  EXPECT_TRUE(missing.error().subject().starts_with("/dev/ttyUSB1"));
  EXPECT_EQ(select_port("").error().code(), problem::several_ports);
}

TEST_F(Hotplug, OtherBridges_AreWrittenToOnlyIfRequested) {
  bed.plug(other);
  const pty printer;
  connect(other, printer);
  pollfd written{printer.master(), POLLIN, 0};
  EXPECT_THAT(*find_lidars({.probe_timeout = 100ms}), IsEmpty());
  EXPECT_FALSE(select_port("", {.probe_timeout = 100ms}));
  EXPECT_FALSE(select_port(number('1'), {.probe_timeout = 100ms}));
  EXPECT_EQ(::poll(&written, 1, 0), 0);
  EXPECT_THAT(*find_lidars({.probe_all_ports = true, .probe_timeout = 100ms}), IsEmpty());
  EXPECT_EQ(::poll(&written, 1, patience_ms), 1);
}

TEST_F(Hotplug, NothingIsFound_PortsWithOtherBridgesAreListed) {
  const bridge ftdi{
      .name = "ttyUSB3", .place = "2-2", .vendor = "0403", .product = "6015", .driver = "ftdi_sio"};
  const auto nothing = select_port("");
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().subject(), "");
  bed.add_builtin("ttyS0", "4");
  bed.plug(other);
  bed.plug(ftdi);
  const auto made = lidar::open("");
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error(), problem::no_port);
  EXPECT_EQ(made.error().detail(), error_detail::other_bridges);
  EXPECT_EQ(
      made.error().subject(),
      "a lidar (not looked at: /dev/ttyUSB2, PL2303; /dev/ttyUSB3, FT231X; /dev/ttyS0, UART)");
}

TEST_F(Hotplug, AllPorts_AreSearchedForTheOnlyLidar) {
  bed.plug(other);
  auto device = serve(other, '1');
  EXPECT_FALSE(lidar::open(""));
  lidar_options options;
  options.probe_all_ports = true;
  auto made = lidar::open(options);
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_EQ(made->name(), "/dev/ttyUSB2");
}

TEST_F(Hotplug, ConsolesAndBluetooth_AreNeverWrittenTo) {
  bed.add_builtin("ttyS0", "4");
  bed.add_builtin("rfcomm0", "4");
  bed.add_active_consoles("tty0 ttyS0");
  const pty console;
  const pty bluetooth;
  std::filesystem::create_symlink(console.path(), bed.dev("ttyS0"));
  std::filesystem::create_symlink(bluetooth.path(), bed.dev("rfcomm0"));
  const find_options all{.probe_all_ports = true, .probe_timeout = 100ms};
  EXPECT_THAT(*find_lidars(all), IsEmpty());
  EXPECT_FALSE(select_port("", all));
  EXPECT_FALSE(select_port(number('1'), all));
  std::array<pollfd, 2> written{{{console.master(), POLLIN, 0}, {bluetooth.master(), POLLIN, 0}}};
  EXPECT_EQ(::poll(written.data(), written.size(), 0), 0);
}

}  // namespace
}  // namespace g4lidar::test
