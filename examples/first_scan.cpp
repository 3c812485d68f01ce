// SPDX-License-Identifier: MIT
// Five revolutions of a G4: the program in the README.
#include <cstdio>
#include <g4lidar/g4lidar.hpp>

int report(const g4lidar::error& why) {
  std::fprintf(stderr, "%s\n", why.message().c_str());  // what went wrong, and what to try
  return 1;
}

int main(int count, char** words) {
  using namespace std::chrono_literals;
  g4lidar::lidar_options options{.device = count > 1 ? words[1] : ""};  // else the only lidar
  options.reconnect = true;                                    // an unplug does not end the loop
  auto lidar = g4lidar::lidar::open(usable_options(options));  // a file does not reconnect
  if (!lidar) return report(lidar.error());
  if (auto started = lidar->start(); !started) return report(started.error());
  int scans_left = 5;
  auto scans = lidar->scans(2s);  // 2 s for a scan that is due; it waits while the motor spins up
  for (const g4lidar::scan& scan : scans) {
    std::printf("%zu points at %.2f Hz\n", scan.size(),
                static_cast<double>(scan.measured_frequency_hz()));
    if (--scans_left == 0) return 0;  // the destructor stops the motor
  }
  return report(*scans.why_ended());
}
