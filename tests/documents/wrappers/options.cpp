// SPDX-License-Identifier: MIT
// Round lines that fill the `options` with which a lidar is opened and started.
#include <chrono>
#include <cstdio>

#include <g4lidar/lidar.hpp>

int main(int, char** words) {
  using namespace std::chrono_literals;
  g4lidar::lidar_options options;
@fragment@
  options.device = words[1];
  auto lidar = g4lidar::lidar::open(options);
  if (!lidar || !lidar->start() || !lidar->next_scan(5s)) return 1;
  std::puts("A lidar with these options has given a scan.");
}
