// SPDX-License-Identifier: MIT
// Converts times of the monotonic clock, which this library uses throughout, to the wall clock.
#pragma once

#include <chrono>
#include <cstdint>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/detail/saturating.hpp"

namespace g4lidar {

/// Converts times of std::chrono::steady_clock to the wall clock. The difference of the clocks is
/// measured at construction and at each update(). Between two updates the converted times keep
/// their distances, also when the wall clock is set. *Single thread, never allocates.* Tests can
/// use other clocks.
///
///     g4lidar::wall_clock wall;
///     const auto stamp = wall.at(scan.points.front().time_ns);
///     if (wall.update() > 1s) log("the wall clock was set");
template <class Wall, class Monotonic>
class basic_wall_clock {
 public:
  using duration = std::chrono::nanoseconds;                  ///< Of all times here.
  using wall_time = std::chrono::time_point<Wall, duration>;  ///< Of the wall clock.
  /// Of the monotonic clock.
  using monotonic_time = std::chrono::time_point<Monotonic, duration>;

  basic_wall_clock() noexcept { static_cast<void>(update()); }

  /// The wall clock at `time`, with the difference that the last update() measured.
  [[nodiscard]] wall_time at(monotonic_time time) const noexcept {
    return wall_time(
        duration(detail::saturating_add(time.time_since_epoch().count(), ahead_.count())));
  }
  /// The same for a time in nanoseconds, such as point::time_ns.
  [[nodiscard]] wall_time at(std::int64_t time_ns) const noexcept {
    return at(monotonic_time(duration(time_ns)));
  }

  /// Measures again. Returns how far the wall clock has moved since the last measurement:
  /// microseconds if the system adjusts its speed, more if it was set. Both clocks are read three
  /// times, and the shortest reading is used, so that an interruption does no harm.
  duration update() noexcept {
    duration best_took = duration::max();
    const duration before = ahead_;
    for (int i = 0; i < 3; ++i) {
      const duration from = Monotonic::now().time_since_epoch();
      const duration wall = Wall::now().time_since_epoch();
      const duration took = Monotonic::now().time_since_epoch() - from;
      if (took >= best_took) continue;
      best_took = took;
      ahead_ = wall - from - took / 2;
    }
    return ahead_ - before;
  }

  /// The difference: wall clock minus monotonic clock.
  [[nodiscard]] duration ahead() const noexcept { return ahead_; }

 private:
  duration ahead_{0};
};

/// With the clocks of the system.
using wall_clock = basic_wall_clock<std::chrono::system_clock, std::chrono::steady_clock>;

}  // namespace g4lidar
