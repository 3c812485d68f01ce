// SPDX-License-Identifier: MIT
// When each sample was measured, counted from the first one at a constant rate.
#pragma once

#include <cstddef>
#include <cstdint>

namespace g4_dump {

/// Nanoseconds since sample 0: exactly floor(index * 10^9 / rate) at every sample, so that no error
/// adds up. Good for 292 years.
class sample_clock {
 public:
  /// Samples a second, 1 to 10^9.
  explicit constexpr sample_clock(std::uint32_t rate_hz) noexcept
      : rate_(rate_hz), step_(second / rate_hz), rest_(second % rate_hz) {}

  /// When the sample to come is measured.
  [[nodiscard]] constexpr std::int64_t now_ns() const noexcept { return now_ns_; }

  /// Goes on by one sample.
  constexpr void tick() noexcept {
    now_ns_ += step_;
    left_ += rest_;
    if (left_ >= rate_) {
      left_ -= rate_;
      ++now_ns_;
    }
  }
  constexpr void tick(std::size_t samples) noexcept {
    for (std::size_t i = 0; i < samples; ++i) tick();
  }

 private:
  static constexpr std::int64_t second = 1'000'000'000;

  std::int64_t rate_;
  std::int64_t step_;
  std::int64_t rest_;
  std::int64_t now_ns_ = 0;
  std::int64_t left_ = 0;  // of a nanosecond, in 1 / rate
};

}  // namespace g4_dump
