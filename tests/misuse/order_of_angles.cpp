// SPDX-License-Identifier: MIT
// Two angles on a circle have no order: asking which is smaller does not compile.
// expect: deleted (function.*operator|operator ')<=>
#include "g4lidar/angle.hpp"

bool misuse(g4lidar::angle a, g4lidar::angle b) {
#ifdef MISUSE
  return a < b;
#else
  return a == b;
#endif
}
