// SPDX-License-Identifier: MIT
// A bare number is no angle: it must say whether it counts degrees or radians.
// expect: could not convert|no viable conversion|conversion from .* to non-scalar type
#include "g4lidar/angle.hpp"

float misuse() {
#ifdef MISUSE
  const g4lidar::angle a = 1.5F;
#else
  const g4lidar::angle a = g4lidar::angle::from_radians(1.5F);
#endif
  return a.degrees();
}
