// SPDX-License-Identifier: MIT
// How long tests wait for what must happen.
#pragma once

#include <chrono>
#include <thread>

namespace g4lidar::test {

/// The limit of a wait for an event. It is at least ten times what an idle machine needs for any event that
/// tests wait for (a reconnect after an unplug: 3 s), because a busy machine may stop a test for seconds. A
/// wait ends with its event: the limit costs time only where the test fails.
inline constexpr std::chrono::seconds patience{60};
inline constexpr int patience_ms = std::chrono::milliseconds(patience).count();  // for poll()

/// Whether this becomes true within the time. It is asked again and again, with pauses of 2 ms.
template <class Condition>
bool comes_true(Condition&& condition, std::chrono::nanoseconds longest = patience) {
  const auto end = std::chrono::steady_clock::now() + longest;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

}  // namespace g4lidar::test
