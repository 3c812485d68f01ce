// SPDX-License-Identifier: MIT
// Two angles on a circle have no order: neither is greater.
// expect: deleted (function.*operator|operator ')<=>
#include "g4lidar/core/angle.hpp"

bool misuse(g4lidar::angle a, g4lidar::angle b) {
#ifdef MISUSE
  return a > b;
#else
  return a.apart_from(b) > 1.0F;
#endif
}
