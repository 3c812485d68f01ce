// SPDX-License-Identifier: MIT
#include "io/playback_clock.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>

namespace {

TEST(PlaybackClock, KeepsItsPlaceWhenSpeedAndPauseChange) {
  constexpr std::int64_t s = 1'000'000'000;
  g4_tool::playback_clock clock;
  EXPECT_EQ(clock.due_ns(100 * s, 101 * s, 5 * s), 6 * s);
  clock.set_speed(2, 7 * s);  // at 102 s
  EXPECT_EQ(clock.due_ns(100 * s, 106 * s, 7 * s), 9 * s);
  clock.pause(true, 8 * s);  // at 104 s
  EXPECT_EQ(clock.due_ns(100 * s, 106 * s, 8 * s), std::nullopt);
  clock.pause(false, 20 * s);
  EXPECT_EQ(clock.due_ns(100 * s, 106 * s, 20 * s), 21 * s);
  clock.set_speed(0, 20 * s);
  EXPECT_EQ(clock.due_ns(100 * s, 206 * s, 20 * s), 20 * s);
  clock.set_speed(1000, 20 * s);  // as 100
  EXPECT_EQ(clock.due_ns(200 * s, 300 * s, 20 * s), 21 * s);
}

}  // namespace
