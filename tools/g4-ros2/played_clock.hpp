// SPDX-License-Identifier: MIT
// The time of a recording that is played. It continues when the recording starts again.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

namespace g4_tool {

/// Nanoseconds since 1970. *Single thread* except for now_ns().
class played_clock {
 public:
  /// The recording starts, or starts again, at `wall_ns`.
  void begin(std::int64_t wall_ns) noexcept {
    if (now_ns_ != 0) shift_ns_ = now_ns_ + pause_ns - wall_ns;
    now_ns_ = wall_ns + shift_ns_;
  }
  /// The stamp of data that was recorded at `wall_ns`: later than all stamps before the last begin().
  [[nodiscard]] std::int64_t stamp_ns(std::int64_t wall_ns) const noexcept {
    return wall_ns + shift_ns_;
  }
  void reach(std::int64_t stamp_ns) noexcept {
    now_ns_ = std::max<std::int64_t>(now_ns_, stamp_ns);
  }
  /// The newest stamp; 0 before the first begin(). *Any thread.*
  [[nodiscard]] std::int64_t now_ns() const noexcept { return now_ns_; }

 private:
  /// More than between two scans.
  static constexpr std::int64_t pause_ns = 1'000'000'000;

  std::int64_t shift_ns_ = 0;
  std::atomic<std::int64_t> now_ns_ = 0;
};

}  // namespace g4_tool
