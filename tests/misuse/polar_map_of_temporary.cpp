// SPDX-License-Identifier: MIT
// A map is a view of points: a map of temporary points does not compile.
// expect: deleted function
#include <vector>

#include "g4lidar/eigen.hpp"

std::vector<g4lidar::point> make_points() { return std::vector<g4lidar::point>(3); }

float misuse() {
#ifdef MISUSE
  const auto map = g4lidar::polar_map(make_points());
#else
  const std::vector<g4lidar::point> points = make_points();
  const auto map = g4lidar::polar_map(points);
#endif
  return map(0, 0);
}
