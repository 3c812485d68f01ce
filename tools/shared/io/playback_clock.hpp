// SPDX-License-Identifier: MIT
// When recorded data is due: a recording is read as fast as it can be, and shown by its times.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

namespace g4_tool {

/// *Pure* but for its own state: the time is an argument. Nanoseconds of the steady clock, and of the
/// recording.
class playback_clock {
 public:
  static constexpr double least_speed = 0.01;
  static constexpr double largest_speed = 100.0;

  /// 0: everything is due at once. From now on: what is due was counted before with the old speed.
  void set_speed(double speed, std::int64_t now_ns) noexcept {
    move_anchor(now_ns);
    if (speed_ == 0) anchor_.reset();  // nobody has counted
    speed_ = speed > 0 ? std::clamp(speed, least_speed, largest_speed) : 0.0;
  }
  [[nodiscard]] double speed() const noexcept { return speed_; }

  void pause(bool pauses, std::int64_t now_ns) noexcept {
    move_anchor(now_ns);
    paused_ = pauses;
  }
  [[nodiscard]] bool is_paused() const noexcept { return paused_; }

  /// The next data begins a new stretch: after an opening, or a seek.
  void restart() noexcept { anchor_.reset(); }

  /// When data recorded at `recorded_ns` is due, where its stretch began with `begin_ns`; nothing while it
  /// is paused.
  [[nodiscard]] std::optional<std::int64_t> due_ns(std::int64_t begin_ns, std::int64_t recorded_ns,
                                                   std::int64_t now_ns) noexcept {
    if (!anchor_) anchor_ = anchor{now_ns, begin_ns};
    if (paused_) return std::nullopt;
    if (speed_ == 0) return now_ns;
    const auto left = static_cast<double>(recorded_ns - anchor_->recorded_ns);
    return anchor_->steady_ns + static_cast<std::int64_t>(left / speed_);
  }

 private:
  struct anchor {
    std::int64_t steady_ns;
    std::int64_t recorded_ns;
  };

  void move_anchor(std::int64_t now_ns) noexcept {
    if (!anchor_) return;
    const auto passed = static_cast<double>(now_ns - anchor_->steady_ns);
    if (!paused_) anchor_->recorded_ns += static_cast<std::int64_t>(passed * speed_);
    anchor_->steady_ns = now_ns;
  }

  std::optional<anchor> anchor_;
  double speed_ = 1.0;
  bool paused_ = false;
};

}  // namespace g4_tool
