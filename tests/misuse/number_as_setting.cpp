// SPDX-License-Identifier: MIT
// A setting has a type of its own: a number does not name the setting.
// expect: no matching function
#include "g4lidar/lidar.hpp"

bool misuse(g4lidar::lidar& lidar) {
#ifdef MISUSE
  return lidar.set(10).has_value();
#else
  return lidar.set(g4lidar::scan_frequency::hz(10)).has_value();
#endif
}
