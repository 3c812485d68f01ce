// SPDX-License-Identifier: MIT
// Two angles on a circle have no order: neither is the greater one.
// expect: deleted (function.*operator|operator ')<=>
#include "g4lidar/angle.hpp"

bool misuse(g4lidar::angle a, g4lidar::angle b) {
#ifdef MISUSE
  return a > b;
#else
  return a.apart_from(b) > 1.0F;
#endif
}
