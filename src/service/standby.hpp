// SPDX-License-Identifier: MIT
// When the motor of a lidar rests because nobody needs its scans.
#pragma once

#include <chrono>
#include <optional>

namespace g4lidar {

/// For programs whose clients come and go: whether the motor is to rest, as background_reader::rest() takes it.
/// *Single thread. Never allocates.*
class standby {
 public:
  /// When something was.
  using time_point = std::chrono::steady_clock::time_point;
  /// How long the motor runs after the last need, so that a client that returns need not wait.
  static constexpr std::chrono::seconds delay{3};

  /// Whether the motor is to rest. `is_needed`: now; where the motor turns without clients, always. Call it several
  /// times a second.
  [[nodiscard]] bool rests(bool is_needed, time_point now) noexcept {
    if (is_needed) needed_ = now;
    return !needed_ || now - *needed_ > delay;
  }

 private:
  std::optional<time_point> needed_;  // the last time
};

}  // namespace g4lidar
