// SPDX-License-Identifier: MIT
// A consumer of the device layer, with the simulated G4. Exit code 0 if it gives a whole scan.
#include <chrono>
#include <memory>

#include "g4lidar/discovery.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/virtual_port.hpp"

int main() {
  using namespace std::chrono_literals;
  if (!g4lidar::list_ports()) return 1;  // whatever there is
  g4lidar::sim::device simulated(g4lidar::sim::built_in_world());
  g4lidar::sim::virtual_clock clock;
  auto lidar =
      g4lidar::lidar::open(std::make_unique<g4lidar::sim::virtual_connector>(simulated, clock));
  if (!lidar || !lidar->start()) return 1;
  const auto scan = lidar->try_scan(2000ms);
  return scan && scan->is_whole() ? 0 : 1;
}
