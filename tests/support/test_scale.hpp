// SPDX-License-Identifier: MIT
// By how much the long tests are to be longer, and under an emulator shorter.
#pragma once

#include <algorithm>
#include <cstdlib>

namespace g4lidar::test {

/// G4LIDAR_TEST_SCALE, at least 1; 1 where it is not set.
[[nodiscard]] inline int test_scale() {
  const char* const given = std::getenv("G4LIDAR_TEST_SCALE");
  return given == nullptr ? 1 : std::max(1, std::atoi(given));
}

/// How many of `count` cases to try, one at least: times test_scale(), and a sixth of them under an
/// emulator, which takes a hundred times as long for arithmetic. There it is to show that another
/// processor reckons the same, and not what is reckoned.
[[nodiscard]] inline int scaled(int count) {
#ifdef G4LIDAR_EMULATED
  return std::max(1, count * test_scale() / 6);
#else
  return count * test_scale();
#endif
}

}  // namespace g4lidar::test
