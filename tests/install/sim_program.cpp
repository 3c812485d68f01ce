// SPDX-License-Identifier: MIT
// A consumer of g4lidar::sim. Exit code 0 if a simulated G4 sends a packet that is valid.
#include "g4lidar/core/packet.hpp"
#include "g4lidar/sim/scanner.hpp"
#include "g4lidar/sim/world.hpp"

int main() {
  g4lidar::sim::scanner device(g4lidar::sim::built_in_world(), {});
  return g4lidar::packet_view::from(device.next().data) ? 0 : 1;
}
