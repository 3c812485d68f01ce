// SPDX-License-Identifier: MIT
// Problems with the selection of a port.
#include <string>

#include "fake_udev.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "scenario.hpp"

namespace g4lidar::test {
namespace {

using trouble = std::optional<error>;

using bridges = std::vector<fake_bridge>;

trouble opening(const std::string& which, const bridges& plugged, bool answers = true) {
  const fake_computer computer(plugged, answers);
  return error_in(lidar::open(which));
}

trouble two_lidars() {
  auto one = sim::background_pty::open(sim::device(sim::built_in_world()));
  auto other = sim::background_pty::open(sim::device(sim::built_in_world()));
  if (!one) return one.error();
  if (!other) return other.error();
  return opening("", {{"1-1", one->path()}, {"1-2", other->path()}});
}

trouble another_lidar() {
  auto one = sim::background_pty::open(sim::device(sim::built_in_world()));
  if (!one) return one.error();
  return opening("serial:2021101000070999", bridges{{"1-1", one->path()}});
}

}  // namespace

std::vector<scenario> place_scenarios() {
  using enum problem;
  return {
      {"NothingPlugged", no_port, task::finding, true, "", [] { return opening("", {}); }},
      {"NothingAtThatPlace", no_port, task::finding, true, "usb:1-9 (ports: /dev/null)",
       [] { return opening("usb:1-9", bridges{{"1-1", "/dev/null"}}); }},
      {"AnotherPortExists", no_port, task::opening, true, "/dev/ttyNothing (ports: /dev/null)",
       [] { return opening("/dev/ttyNothing", bridges{{"1-1", "/dev/null"}}); }},
      {"AnotherLidar", no_port, task::finding, true, "serial:2021101000070999", another_lidar},
      {"NoSerialNumber", bad_option, task::finding, true, "serial:42, not 16 digits",
       [] { return opening("serial:42", {}); }},
      {"TwoLidars", several_ports, task::finding, true, ", /dev/", two_lidars},
      {"NoListOfPorts", system, task::finding, true, "udev", [] { return opening("", {}, false); }},
  };
}

}  // namespace g4lidar::test
