// SPDX-License-Identifier: MIT
// The times of samples whose arrival times are not known: counted from the first sample at a
// constant rate.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace g4lidar {

/// Nanoseconds since sample 0: exactly floor(index * 10^9 / rate) at every sample, so no error
/// accumulates. Valid for 292 years. *Single thread, never allocates.* (protocol: Point packets)
class sample_clock {
 public:
  /// `sample_rate_hz`: 1 to 10^9; 0 counts as 1.
  explicit constexpr sample_clock(std::uint32_t sample_rate_hz) noexcept
      : rate_(std::max(sample_rate_hz, std::uint32_t{1})),
        step_(second / rate_),
        rest_(second % rate_) {}

  /// The time of the next sample.
  [[nodiscard]] constexpr std::int64_t now_ns() const noexcept { return now_ns_; }

  /// Advances by one sample.
  constexpr void tick() noexcept {
    now_ns_ += step_;
    left_ += rest_;
    if (left_ >= rate_) {
      left_ -= rate_;
      ++now_ns_;
    }
  }
  /// Advances by `samples` samples.
  constexpr void tick(std::size_t samples) noexcept {
    for (std::size_t i = 0; i < samples; ++i) tick();
  }

 private:
  static constexpr std::int64_t second = 1'000'000'000;

  std::int64_t rate_;
  std::int64_t step_;
  std::int64_t rest_;
  std::int64_t now_ns_ = 0;
  std::int64_t left_ = 0;  // remainder of the nanosecond, in 1 / rate
};

}  // namespace g4lidar
