// SPDX-License-Identifier: MIT
// An ignored result of stop() and close() hides that the motor may still turn.
// expect: ignoring return value.*stop
// expect: ignoring return value.*close
#include "g4lidar/lidar.hpp"

bool misuse(g4lidar::lidar& lidar) {
#ifdef MISUSE
  lidar.stop();
  lidar.close();
  return true;
#else
  return lidar.stop().has_value() && lidar.close().has_value();
#endif
}
