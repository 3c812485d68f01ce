// SPDX-License-Identifier: MIT
// A loop over the points of a temporary scan does not compile.
// expect: deleted function.*operator->|overload resolution selected deleted operator '->'
#include <chrono>

#include "g4lidar/lidar.hpp"

using namespace std::chrono_literals;

float misuse(g4lidar::lidar& lidar) {
  float sum = 0;
#ifdef MISUSE
  for (const g4lidar::point& p : lidar.try_scan(2s)->points) sum += p.range_mm;
#else
  const auto scan = lidar.try_scan(2s);
  for (const g4lidar::point& p : scan->points) sum += p.range_mm;
#endif
  return sum;
}
