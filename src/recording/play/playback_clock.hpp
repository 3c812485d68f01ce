// SPDX-License-Identifier: MIT
// The clock of a file that is played.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "g4lidar/detail/saturating.hpp"
#include "transport/fd_port.hpp"

namespace g4lidar {

/// By the times of the recording. At speed 0 reads move it forward; while it is paused it stands.
class playback_clock {
 public:
  playback_clock(double speed, std::int64_t begin_ns) noexcept : speed_(speed) { seek(begin_ns); }

  [[nodiscard]] double speed() const noexcept { return speed_; }
  [[nodiscard]] bool is_paused() const noexcept { return is_paused_; }
  /// Whether everything is due at once.
  [[nodiscard]] bool is_free() const noexcept { return speed_ == 0 && !is_paused_; }
  [[nodiscard]] std::int64_t now_ns() const noexcept {
    if (is_paused_ || speed_ == 0) return now_ns_;
    const auto since = static_cast<double>(steady_now_ns() - begun_ns_) * speed_;
    return std::max(now_ns_,
                    detail::saturating_add(begin_ns_, detail::saturated<std::int64_t>(since)));
  }
  /// When this clock will be `at_ns`, by the steady clock. While it is paused: when a wait of as long ends.
  [[nodiscard]] std::int64_t steady_ns(std::int64_t at_ns) const noexcept {
    if (is_paused_)
      return detail::saturating_add(steady_now_ns(), detail::saturating_sub(at_ns, now_ns_));
    const auto left = static_cast<double>(detail::saturating_sub(at_ns, begin_ns_)) / speed_;
    return detail::saturating_add(begun_ns_, detail::saturated<std::int64_t>(std::max(left, 0.0)));
  }
  /// The time that has passed for a caller, at all speeds: by the steady clock, and at speed 0 by this clock.
  [[nodiscard]] std::int64_t caller_ns() const noexcept {
    const std::int64_t since_ns =
        is_free() ? detail::saturating_sub(now_ns_, begin_ns_) : steady_now_ns() - begun_ns_;
    return detail::saturating_add(passed_ns_, since_ns);
  }
  /// The time of this clock when caller_ns() is `at_ns`, if neither changes; while it stands, after a wait
  /// of as long.
  [[nodiscard]] std::int64_t at_caller_ns(std::int64_t at_ns) const noexcept {
    const std::int64_t left_ns = detail::saturating_sub(at_ns, caller_ns());
    if (is_paused_ || speed_ == 0) return detail::saturating_add(now_ns_, left_ns);
    const double time = std::ceil(static_cast<double>(left_ns) * speed_);
    return detail::saturating_add(now_ns(), detail::saturated<std::int64_t>(time));
  }

  /// It never goes back.
  void advance_to(std::int64_t at_ns) noexcept { now_ns_ = std::max(now_ns_, at_ns); }
  void set_speed(double speed) noexcept {
    seek(now_ns());
    speed_ = speed;
  }
  void pause(bool pauses) noexcept {
    seek(now_ns());
    is_paused_ = pauses;
  }
  void seek(std::int64_t at_ns) noexcept {
    passed_ns_ = caller_ns();
    begin_ns_ = now_ns_ = at_ns;
    begun_ns_ = steady_now_ns();
  }

 private:
  double speed_;
  bool is_paused_ = false;
  std::int64_t begin_ns_ = 0;
  std::int64_t now_ns_ = 0;
  std::int64_t begun_ns_ = steady_now_ns();
  std::int64_t passed_ns_ = 0;  // for a caller, until then
};

}  // namespace g4lidar
