// SPDX-License-Identifier: MIT
// Times in the output: of the monotonic clock, of the wall clock, or relative.
#pragma once

#include <cstdint>

#include "cli/written_form.hpp"
#include "io/far_times.hpp"

namespace g4_tool {

/// Converts times of the monotonic clock to those of a time_style. Results beyond 64 bits become the
/// largest or the least value. *Single thread, never allocates.*
class time_shift {
 public:
  /// `wall_ahead_ns`: wall clock minus monotonic clock, for time_style::absolute.
  constexpr time_shift(time_style style, std::int64_t wall_ahead_ns) noexcept
      : style_(style), shift_ns_(style == time_style::absolute ? wall_ahead_ns : 0) {}

  /// Whether of() returns its argument unchanged.
  [[nodiscard]] constexpr bool changes_nothing() const noexcept {
    if (style_ == time_style::zero) return begun_ && before_ns_ == 0;
    return style_ != time_style::delta && shift_ns_ == 0;
  }

  /// Data with this time has arrived, written or not; time_style::zero and the first delta count
  /// from the first such time.
  constexpr void arrived(std::int64_t time_ns) noexcept {
    if (begun_) return;
    begun_ = true;
    before_ns_ = time_ns;
  }
  /// The time to write for the next record.
  [[nodiscard]] constexpr std::int64_t of(std::int64_t time_ns) noexcept {
    if (style_ == time_style::zero) return begun_ ? way_ns(before_ns_, time_ns) : time_ns;
    if (style_ != time_style::delta) return sum_ns(time_ns, shift_ns_);
    const std::int64_t since_ns = written_ ? way_ns(before_ns_, time_ns) : 0;
    written_ = true;
    before_ns_ = time_ns;
    return since_ns;
  }
  /// The wall clock may have been set. Differences below 1 ms are ignored: the two clocks cannot be
  /// read at the same time, and written times should not jitter.
  constexpr void set_wall_ahead(std::int64_t wall_ahead_ns) noexcept {
    constexpr std::int64_t step_ns = 1'000'000;
    const std::int64_t change_ns = way_ns(shift_ns_, wall_ahead_ns);
    if (style_ != time_style::absolute || (change_ns > -step_ns && change_ns < step_ns)) return;
    shift_ns_ = wall_ahead_ns;
  }

 private:
  time_style style_;
  bool begun_ = false;
  bool written_ = false;
  std::int64_t shift_ns_;
  std::int64_t before_ns_ = 0;
};

}  // namespace g4_tool
