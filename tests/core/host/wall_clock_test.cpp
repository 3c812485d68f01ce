// SPDX-License-Identifier: MIT
// From the monotonic clock to the wall clock, with clocks that the test sets.
#include "g4lidar/core/wall_clock.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>

namespace g4lidar {
namespace {

using namespace std::chrono_literals;

/// A clock that only the test moves.
template <int Which>
struct test_clock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<test_clock>;
  static constexpr bool is_steady = false;
  static inline duration time{0};
  static time_point now() noexcept { return time_point(time); }
};

/// Each of its readings takes time, one of them long: there the program is interrupted.
struct busy_clock : test_clock<1> {
  using time_point = std::chrono::time_point<busy_clock>;
  static inline int readings = 0;
  static time_point now() noexcept;
};
struct set_clock : test_clock<2> {
  using time_point = std::chrono::time_point<set_clock>;
  static time_point now() noexcept { return time_point(time); }
};

void pass(std::chrono::nanoseconds time) {
  busy_clock::time += time;
  set_clock::time += time;
}

busy_clock::time_point busy_clock::now() noexcept {
  pass(++readings == 2 ? 50ms : 1us);
  return time_point(time);
}

using clock_under_test = basic_wall_clock<set_clock, busy_clock>;

TEST(WallClock, Update_FollowsAStep) {
  busy_clock::readings = 0;
  busy_clock::time = 100s;
  set_clock::time = 1'700'000'000s;
  clock_under_test wall;  // its first reading is interrupted for 50 ms: another one is used
  EXPECT_NEAR(static_cast<double>((wall.ahead() - 1'699'999'900s).count()), 0.0, 1000.0);
  const std::int64_t before_ns = 105'000'000'000;
  const auto then = wall.at(before_ns);
  EXPECT_NEAR(static_cast<double>((then.time_since_epoch() - 1'700'000'005s).count()), 0.0, 1000.0);

  pass(5s);
  EXPECT_LT(wall.update(), 2us);
  set_clock::time += 1h;  // the clock is set
  EXPECT_EQ(wall.at(before_ns + 1'000'000'000) - wall.at(before_ns), 1s);
  const auto moved = wall.update();
  EXPECT_GT(moved, 1h - 2us);
  EXPECT_LT(moved, 1h + 2us);
  EXPECT_NEAR(static_cast<double>((wall.at(before_ns) - then - 1h).count()), 0.0, 2000.0);
  set_clock::time -= 2h;  // and back
  EXPECT_LT(wall.update(), -2h + 2us);
  EXPECT_LT(wall.at(before_ns), then);
}

TEST(WallClock, AgreesWithTheSystemClocks) {
  const wall_clock wall;
  const auto before = std::chrono::system_clock::now();
  const auto converted = wall.at(std::chrono::steady_clock::now());
  const auto after = std::chrono::system_clock::now();
  EXPECT_GT(converted, before - 1s);
  EXPECT_LT(converted, after + 1s);
}

}  // namespace
}  // namespace g4lidar
