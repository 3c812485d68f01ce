// SPDX-License-Identifier: MIT
// The clock of a replay.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/saturating.hpp"
#include "transport/fd_port.hpp"

namespace g4lidar {

/// The clock of the recorded transport. At rate 0 reads move it forward.
class replay_clock {
 public:
  replay_clock(double rate, std::int64_t begin_ns) noexcept
      : rate_(rate), begin_ns_(begin_ns), now_ns_(begin_ns), begun_ns_(steady_now_ns()) {}

  [[nodiscard]] bool is_free() const noexcept { return rate_ == 0; }
  [[nodiscard]] std::int64_t now_ns() const noexcept {
    if (is_free()) return now_ns_;
    const auto since = static_cast<double>(steady_now_ns() - begun_ns_) * rate_;
    return std::max(now_ns_, saturating_add(begin_ns_, saturating_ns(since)));
  }
  /// When this clock will be `at_ns`, by the steady clock.
  [[nodiscard]] std::int64_t steady_ns(std::int64_t at_ns) const noexcept {
    const auto left = static_cast<double>(saturating_sub(at_ns, begin_ns_)) / rate_;
    return saturating_add(begun_ns_, saturating_ns(std::max(left, 0.0)));
  }
  /// The time of this clock when the steady clock has advanced by `time_ns`; a recording that is
  /// played without waiting has a clock of its own.
  [[nodiscard]] std::int64_t after_ns(std::int64_t time_ns) const noexcept {
    if (is_free()) return saturating_add(now_ns_, time_ns);
    return saturating_add(now_ns(), saturating_ns(static_cast<double>(time_ns) * rate_));
  }
  /// It never goes back.
  void advance_to(std::int64_t at_ns) noexcept { now_ns_ = std::max(now_ns_, at_ns); }

 private:
  double rate_;
  std::int64_t begin_ns_;
  std::int64_t now_ns_;
  std::int64_t begun_ns_;
};

}  // namespace g4lidar
