// SPDX-License-Identifier: MIT
// An ignored result of start() hides that the scan may not run.
// expect: ignoring return value
#include "g4lidar/lidar.hpp"

bool misuse(g4lidar::lidar& lidar) {
#ifdef MISUSE
  lidar.start();
  return true;
#else
  return lidar.start().has_value();
#endif
}
