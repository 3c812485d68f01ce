// SPDX-License-Identifier: MIT
// Round lines that look at one whole `scan` of a lidar.
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <vector>

#include <g4lidar/cartesian.hpp>
#include <g4lidar/grid.hpp>
#include <g4lidar/lidar.hpp>

namespace {

void look_at(const g4lidar::scan& scan) {
@fragment@
}

}  // namespace

int main(int, char** words) {
  using namespace std::chrono_literals;
  auto lidar = g4lidar::lidar::open(words[1]);
  if (!lidar || !lidar->start()) return 1;
  for (int scans = 0; scans < 3;) {
    const auto scan = lidar->next_scan(5s);
    if (!scan) return 1;
    ++scans;
    look_at(*scan);
  }
  std::puts("Three scans were looked at.");
}
