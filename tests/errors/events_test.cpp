// SPDX-License-Identifier: MIT
// Each event is reported, with its reason.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/virtual_port.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
using kind = lidar_event::kind;
using sim::fault_kind;
using sim::make_fault;

constexpr std::int64_t second = 1'000'000'000;

/// The events while an application reads for twelve seconds with reconnecting on.
struct story {
  std::string name;
  kind what;
  problem reason;
  sim::fault fault;
  bool found_protected = false;  ///< The protection of the device is on at the start.
  std::int64_t silent_ns = 0;    ///< From the scan header to the first packet.
  std::int64_t asleep_ns = 0;    ///< The application is suspended for this time, at 4 s.
};

void PrintTo(const story& of, std::ostream* out) { *out << of.name; }

sim::device device_of(const story& of) {
  sim::device_options options;
  if (of.found_protected) options.initial.protection = power_down_protection::on;
  options.silence_ns = of.silent_ns;
  return sim::device(sim::built_in_world(), options, {&of.fault, 1});
}

std::vector<lidar_event> lived(const story& of) {
  sim::device simulated = device_of(of);
  sim::virtual_clock clock;
  clock.advance_to(second);  // by then a scanning device has reached its speed
  lidar_options options;
  options.reconnect = true;
  if (of.asleep_ns > 0) options.protection = power_down_protection::on;
  auto device = lidar::open(std::make_unique<sim::virtual_connector>(simulated, clock), options);
  EXPECT_TRUE(device);
  if (!device) return {};
  static_cast<void>(device->start());
  bool is_asleep = of.asleep_ns > 0;
  while (clock.now_ns() < 12 * second) {
    const auto scan = device->try_scan(500ms);
    EXPECT_TRUE(scan || !scan.error().is_fatal()) << scan.error().message();
    if (!scan && scan.error().is_fatal()) break;
    if (is_asleep && clock.now_ns() > 4 * second) {
      clock.advance_to(clock.now_ns() + of.asleep_ns);
      is_asleep = false;
    }
  }
  std::vector<lidar_event> events;
  while (const auto event = device->next_event()) events.push_back(*event);
  return events;
}

class Event : public testing::TestWithParam<story> {};

TEST_P(Event, IsReported) {
  const auto events = lived(GetParam());
  const auto found = std::ranges::find_if(events, [](const lidar_event& event) {
    const bool has_reason = event.what == kind::lost;
    return event.what == GetParam().what && (!has_reason || event.reason == GetParam().reason);
  });
  std::string all;
  for (const auto& event : events) {
    all.append(name_of(event.what)).append(" ").append(name_of(event.reason)).append(", ");
  }
  EXPECT_NE(found, events.end()) << all;
}

sim::fault none() { return make_fault(fault_kind::flip, 3600 * second, second); }

INSTANTIATE_TEST_SUITE_P(
    All, Event,
    testing::Values(
        story{"Unplugged", kind::lost, problem::gone,
              make_fault(fault_kind::unplug, 4 * second, second)},
        story{"Stalled", kind::lost, problem::stalled,
              make_fault(fault_kind::stall, 4 * second, 6 * second)},
        story{"TooLittlePower", kind::lost, problem::brown_out, make_fault(fault_kind::brown_out)},
        story{"BackAgain", kind::reconnected, problem::gone,
              make_fault(fault_kind::unplug, 4 * second, second)},
        story{"FoundScanning", kind::found_scanning, problem::timeout,
              make_fault(fault_kind::scanning)},
        story{"LookedTooLate", kind::protection_starved, problem::timeout, none(), false, 0,
              4 * second},
        story{"FoundProtected", kind::protection_found_on, problem::timeout, none(), true},
        story{"ColdMotor", kind::spinning_up, problem::timeout, none(), false, 2'500'000'000},
        story{"StartedAgain", kind::restarted, problem::timeout,
              make_fault(fault_kind::stall, 6 * second, 2 * second)},
        story{"WarnsOfItsHealth", kind::health_warning, problem::timeout,
              sim::fault{fault_kind::health, 0, sim::forever_ns, 0.0, 1}}),
    [](const auto& of) { return of.param.name; });

TEST(Events, OldestAreDroppedAndThatIsReported) {
  sim::device simulated(sim::built_in_world());
  sim::virtual_clock clock;
  lidar_options options;
  options.reconnect = true;
  auto device = lidar::open(std::make_unique<sim::virtual_connector>(simulated, clock), options);
  ASSERT_TRUE(device);
  ASSERT_TRUE(device->start());
  for (int replug = 0; replug < 20; ++replug) {
    simulated.unplug(clock.now_ns());
    static_cast<void>(device->try_scan(100ms));
    simulated.replug(clock.now_ns());
    for (int tries = 0; tries < 10 && !device->try_scan(500ms); ++tries) {
    }
  }
  std::vector<kind> reported;
  while (const auto event = device->next_event()) reported.push_back(event->what);
  ASSERT_EQ(reported.size(), 33U);
  EXPECT_EQ(reported.front(), kind::overflow);
  EXPECT_EQ(std::ranges::count(reported, kind::overflow), 1);
}

}  // namespace
}  // namespace g4lidar::test
