// SPDX-License-Identifier: MIT
// Angles on a circle cannot be sorted: they have no first one.
// expect: deleted (function.*operator|operator ')<=>
#include <algorithm>
#include <array>

#include "g4lidar/core/angle.hpp"

void misuse(std::array<g4lidar::angle, 10>& angles) {
#ifdef MISUSE
  std::sort(angles.begin(), angles.end());
#else
  const g4lidar::angle from;
  std::sort(angles.begin(), angles.end(), [from](g4lidar::angle a, g4lidar::angle b) {
    return from.forward_to(a) < from.forward_to(b);
  });
#endif
}
