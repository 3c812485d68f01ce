// SPDX-License-Identifier: MIT
// Problems of the device: a driver with the simulated device, in virtual time.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "scenario.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
using sim::fault_kind;
using sim::make_fault;

using faults = std::vector<sim::fault>;
using trouble = std::optional<error>;

constexpr std::int64_t second = 1'000'000'000;

struct bench {
  explicit bench(const faults& wrong = {}, const sim::device_options& options = {})
      : device(sim::built_in_world(), options, wrong) {}

  [[nodiscard]] result<lidar> open(const lidar_options& options = {}) {
    return lidar::open(std::make_unique<sim::virtual_connector>(device, clock), options);
  }

  sim::device device;
  sim::virtual_clock clock;
};

/// The error of `does(device)`, if opening succeeded.
template <class Does>
trouble once_open(bench& on, Does does, const lidar_options& options = {}) {
  auto device = on.open(options);
  if (!device) return device.error();
  return does(*device);
}

/// The same, during a scan.
template <class Does>
trouble once_scanning(bench& on, Does does, const lidar_options& options = {}) {
  return once_open(
      on,
      [&](lidar& device) {
        auto started = device.start();
        return started ? does(device) : error_in(started);
      },
      options);
}

/// The loop of an application, for a minute.
trouble application(lidar& device, const bench& on) {
  while (on.clock.now_ns() < 60 * second) {
    const auto scan = device.try_scan(500ms);
    if (!scan && scan.error().is_fatal()) return scan.error();
  }
  return std::nullopt;
}

/// The time is after four seconds; by then everything should be normal.
constexpr std::int64_t later = 4 * second;
void wait_until(bench& on, std::int64_t then_ns) { on.clock.advance_to(then_ns); }

trouble opening(const faults& wrong, const sim::device_options& options = {}) {
  bench on(wrong, options);
  return error_in(on.open());
}

trouble asking(fault_kind wrong, const request& wanted) {
  bench on({make_fault(wrong, later)});
  return once_open(on, [&](lidar& device) {
    wait_until(on, later + 1);
    return error_in(device.ask(wanted));
  });
}

trouble running(const faults& wrong) {
  bench on(wrong);
  return once_scanning(on, [&](lidar& device) { return application(device, on); });
}

trouble unpowered() {
  sim::device_options options;
  options.boots_at_start = true;
  options.boot_ns = 60 * second;  // longer than any timeout
  return opening({}, options);
}

trouble dies_before_start() {
  bench on({make_fault(fault_kind::stall, later)});
  return once_open(on, [&](lidar& device) {
    wait_until(on, later + 1);
    return error_in(device.start());
  });
}

trouble another_model() {
  sim::device_options options;
  options.info.model = 4;
  return opening({}, options);
}

trouble frequency_of_an_x4() {
  sim::device_options options;
  static_cast<void>(sim::use_model(options, "x4"));
  bench on({}, options);
  const auto ask = [](lidar& device) {
    return error_in(device.ask(requests::get_scan_frequency()));
  };
  return once_open(on, ask, {.model = model_named("x4")});
}

trouble deaf_when_stopped() {
  bench on({make_fault(fault_kind::deaf, later)});
  return once_scanning(on, [&](lidar& device) {
    while (on.clock.now_ns() < later) static_cast<void>(device.try_scan(500ms));
    return error_in(device.stop());
  });
}

trouble deaf_when_asked() {
  bench on({make_fault(fault_kind::deaf, later)});
  return once_scanning(on, [&](lidar& device) {
    while (on.clock.now_ns() < later) static_cast<void>(device.try_scan(500ms));
    return error_in(device.ask(requests::health(), while_scanning::stop_and_resume));
  });
}

trouble health_error() {
  bench on({make_fault(fault_kind::health)});
  return once_open(on, [](lidar& device) { return error_in(device.start()); });
}

trouble no_scan_yet() {
  bench on;
  return once_scanning(on, [](lidar& device) { return error_in(device.try_scan(10ms)); });
}

trouble frequency_too_high() {
  sim::device_options slow;
  slow.highest_frequency_chz = 1000;
  bench on({}, slow);
  return once_open(
      on, [](lidar& device) { return error_in(device.ask(requests::set(scan_frequency{1200}))); });
}

trouble looked_for() {
  bench on({make_fault(fault_kind::unplug, later)});
  lidar_options options;
  options.reconnect = true;
  const auto wait = [](lidar& device) {
    while (device.try_scan(2s)) {
    }
    return error_in(device.try_scan(100ms));
  };
  return once_scanning(on, wait, options);
}

trouble asked_how(int how) {
  bench on;
  return once_open(
      on, [&](lidar& of) { return error_in(of.ask(requests::health(), while_scanning(how))); });
}

/// The error of `wanted`, which is refused before a byte is sent.
trouble refused(const request& wanted) {
  bench on;
  return once_open(on, [&](lidar& device) {
    const auto sent = on.device.log().size();
    auto why = error_in(device.ask(wanted));
    EXPECT_EQ(on.device.log().size(), sent);
    EXPECT_TRUE(device.start());
    return why;
  });
}

trouble asked_while_scanning() {
  bench on;
  return once_scanning(on, [](lidar& device) { return error_in(device.ask(requests::health())); });
}

trouble read_before_start() {
  bench on;
  return once_open(on, [](lidar& device) { return error_in(device.try_scan(10ms)); });
}

/// The first error of a call that is repeated, with reconnecting on, until the unplug.
template <class Call>
trouble unplugged_with_reconnecting(Call call) {
  bench on({make_fault(fault_kind::unplug, later)});
  lidar_options options;
  options.reconnect = true;
  return once_scanning(
      on,
      [&](lidar& device) -> trouble {
        while (true) {
          const auto done = call(device);
          if (done) continue;
          // Immediately, and not at the timeout of the call.
          if (on.clock.now_ns() > later + second / 10) return std::nullopt;
          return done.error();
        }
      },
      options);
}

trouble unplugged_when_idle() {
  bench on;
  return once_open(on, [&](lidar& device) {
    on.device.unplug(on.clock.now_ns());
    return error_in(device.ask(requests::health()));
  });
}

trouble not_plugged() {
  bench on;
  on.device.unplug(0);
  return error_in(on.open());
}

trouble used_after_close() {
  bench on;
  return once_open(on, [&](lidar& device) {
    static_cast<void>(device.close());
    return error_in(device.start());
  });
}

trouble woken() {
  bench on;
  return once_scanning(on, [](lidar& device) {
    device.wake();
    return error_in(device.try_scan(500ms));
  });
}

trouble option_out_of_range() {
  bench on;
  lidar_options options;
  options.frequency = scan_frequency{1300};
  return error_in(on.open(options));
}

}  // namespace

std::vector<scenario> device_scenarios() {
  using enum problem;
  return {
      {"MuteDevice", silence, task::opening, true, "virtual:g4",
       [] { return opening({make_fault(fault_kind::mute)}); }},
      {"UnpoweredDevice", silence, task::opening, true, "virtual:g4", unpowered},
      {"DiesBeforeStart", silence, task::starting, true, "virtual:g4", dies_before_start},
      {"WrongBaudRateOfAnIdleDevice", silence, task::opening, true, "virtual:g4",
       [] { return opening({make_fault(fault_kind::baud)}); }},
      {"WrongBaudRateOfAScanningDevice", garbage, task::opening, true, "virtual:g4",
       [] { return opening({make_fault(fault_kind::scanning), make_fault(fault_kind::baud)}); }},
      {"AnotherModel", other_device, task::opening, true, "virtual:g4, model 4", another_model},
      {"ScansAndIsDeaf", does_not_stop, task::opening, true, "virtual:g4",
       [] { return opening({make_fault(fault_kind::scanning), make_fault(fault_kind::deaf)}); }},
      {"DeafWhenStopped", does_not_stop, task::stopping, true, "virtual:g4", deaf_when_stopped},
      {"DeafWhenAsked", does_not_stop, task::asking, true, "virtual:g4, health", deaf_when_asked},
      {"HealthError", unhealthy, task::starting, true, "virtual:g4, error code", health_error},
      {"NoScanYet", timeout, task::reading, false, "virtual:g4", no_scan_yet},
      {"LostAndLookedFor", timeout, task::reading, false, "virtual:g4", looked_for},
      {"NoAnswer", timeout, task::asking, false, "virtual:g4, health",
       [] { return asking(fault_kind::mute, requests::health()); }},
      {"WrongAnswers", wrong_answer, task::asking, false, "virtual:g4, direction",
       [] { return asking(fault_kind::wrong, requests::get_direction()); }},
      {"FrequencyTooHigh", not_reached, task::asking, false,
       "virtual:g4, scan frequency 12 Hz (reached 10 Hz)", frequency_too_high},
      {"FrequencyOutOfRange", bad_setting, task::asking, false, "virtual:g4, scan frequency 15 Hz",
       [] { return refused(requests::set(scan_frequency{1500})); }},
      {"NoSuchValue", bad_setting, task::asking, false, "virtual:g4, power-down protection",
       [] { return refused(requests::set(static_cast<power_down_protection>(77))); }},
      {"FrequencyOfAnX4", not_supported, task::asking, false, "virtual:g4, scan frequency, X4",
       frequency_of_an_x4},
      {"NoSuchPermission", bad_option, task::asking, true, "how: ", [] { return asked_how(9); }},
      {"AskedWhileScanning", scanning, task::asking, false, "virtual:g4, health",
       asked_while_scanning},
      {"ReadBeforeStart", not_scanning, task::reading, true, "virtual:g4", read_before_start},
      {"NotPlugged", no_port, task::opening, true, "virtual:g4", not_plugged},
      {"UnpluggedWhileScanning", gone, task::reading, true, "virtual:g4",
       [] { return running({make_fault(fault_kind::unplug, later)}); }},
      {"LostWhileWaitingForAScan", reconnecting, task::reading, false, "virtual:g4, gone",
       [] { return unplugged_with_reconnecting([](lidar& on) { return on.try_scan(2s); }); }},
      {"LostWhileWaitingForPoints", reconnecting, task::reading, false, "virtual:g4, gone",
       [] { return unplugged_with_reconnecting([](lidar& on) { return on.next_points(2s); }); }},
      {"UnpluggedWhenIdle", gone, task::writing, true, "virtual:g4", unplugged_when_idle},
      {"UsedAfterClose", gone, task::reading, true, "closed", used_after_close},
      {"StreamStops", stalled, task::reading, true, "virtual:g4",
       [] { return running({make_fault(fault_kind::stall, later)}); }},
      {"DiesWithTheMotor", brown_out, task::starting, true, "virtual:g4",
       [] { return running({make_fault(fault_kind::brown_out)}); }},
      {"RebootsWithTheMotor", brown_out, task::starting, true, "virtual:g4",
       [] { return running({make_fault(fault_kind::reboot)}); }},
      {"Woken", cancelled, task::reading, false, "virtual:g4", woken},
      {"OptionOutOfRange", bad_option, task::configuring, true, "frequency", option_out_of_range},
  };
}

}  // namespace g4lidar::test
