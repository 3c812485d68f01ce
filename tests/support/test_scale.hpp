// SPDX-License-Identifier: MIT
// The factor by which long tests are longer, and under an emulator shorter.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <ranges>

namespace g4lidar::test {

/// G4LIDAR_TEST_SCALE, at least 1; 1 if it is not set.
[[nodiscard]] inline int test_scale() {
  const char* const given = std::getenv("G4LIDAR_TEST_SCALE");
  return given == nullptr ? 1 : std::max(1, std::atoi(given));
}

/// How many of `count` cases to try, at least one: times test_scale(), and a sixth of them under an
/// emulator, which takes a hundred times as long for arithmetic. There the test shows that another
/// processor computes the same.
[[nodiscard]] inline int scaled(int count) {
#ifdef G4LIDAR_EMULATED
  return std::max(1, count * test_scale() / 6);
#else
  return count * test_scale();
#endif
}

/// `count` seeds for random inputs, scaled: fixed ones from 1 on by default. The nightly sets
/// G4LIDAR_TEST_SEED to another number each day, and prints it.
[[nodiscard]] inline auto seeds(int count) {
  const char* const given = std::getenv("G4LIDAR_TEST_SEED");
  const int first = given == nullptr ? 1 : 1 + std::atoi(given) % 1'000'000 * 1'000;
  return std::views::iota(first, first + scaled(count));
}

}  // namespace g4lidar::test
