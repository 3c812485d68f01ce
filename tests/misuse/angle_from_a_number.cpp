// SPDX-License-Identifier: MIT
// A number is not an angle: the unit, degrees or radians, must be named.
// expect: could not convert|no viable conversion|conversion from .* to non-scalar type
#include "g4lidar/core/angle.hpp"

float misuse() {
#ifdef MISUSE
  const g4lidar::angle a = 1.5F;
#else
  const g4lidar::angle a = g4lidar::angle::from_radians(1.5F);
#endif
  return a.degrees();
}
