// SPDX-License-Identifier: MIT
// By how much the long tests are to be longer.
#pragma once

#include <algorithm>
#include <cstdlib>

namespace g4lidar::test {

/// G4LIDAR_TEST_SCALE, at least 1; 1 where it is not set.
[[nodiscard]] inline int test_scale() {
  const char* const given = std::getenv("G4LIDAR_TEST_SCALE");
  return given == nullptr ? 1 : std::max(1, std::atoi(given));
}

}  // namespace g4lidar::test
