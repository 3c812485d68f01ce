// SPDX-License-Identifier: MIT
// Readers of the points of a lidar cannot write to them.
// expect: discards qualifiers|not marked const
#include "g4lidar/lidar.hpp"

bool misuse(g4lidar::lidar& lidar) {
#ifdef MISUSE
  lidar.points().push(g4lidar::point{});
#endif
  return lidar.points().make_reader().ahead() == 0;
}
