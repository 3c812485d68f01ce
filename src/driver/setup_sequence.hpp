// SPDX-License-Identifier: MIT
// The commands to a device before it scans, and their order.
#pragma once

#include <bit>
#include <cstdint>
#include <utility>

#include "g4lidar/lidar.hpp"

namespace g4lidar {

/// The steps, in their order.
enum class setup_step : std::uint8_t {
  identify,
  stop,
  health,
  ranging,
  frequency,
  direction,
  constant,
  idle,
  protection,
  start,
};

/// The remaining steps. *Single thread, never allocates.* Each step is contained at most once, so
/// there is always room for all of them.
class setup_sequence {
 public:
  void add(setup_step step) noexcept { left_ |= bit(step); }
  /// The steps of a start: the health, the settings of the options, and the start.
  void add_start(const lidar_options& options) noexcept {
    is_repeated_ = false;
    add_steps(options);
  }
  /// The same steps once more, because the device may have restarted during them; `scans`: it scans
  /// already. False if that has been done since add_start().
  [[nodiscard]] bool repeat_start(const lidar_options& options, bool scans) noexcept {
    if (std::exchange(is_repeated_, true)) return false;
    if (scans) add(setup_step::stop);
    add_steps(options);
    return true;
  }
  void clear() noexcept { left_ = 0; }

  [[nodiscard]] bool is_done() const noexcept { return left_ == 0; }
  /// The first remaining step; only if not is_done().
  [[nodiscard]] setup_step next() const noexcept {
    return static_cast<setup_step>(std::countr_zero(left_));
  }
  /// Removes next().
  void finish_next() noexcept { left_ &= left_ - 1U; }

 private:
  [[nodiscard]] static unsigned bit(setup_step step) noexcept {
    return 1U << static_cast<unsigned>(step);
  }
  void add_steps(const lidar_options& options) noexcept {
    add(setup_step::health);
    add(setup_step::ranging);  // queried if it is not set
    if (options.frequency) add(setup_step::frequency);
    if (options.direction) add(setup_step::direction);
    if (options.constant) add(setup_step::constant);
    if (options.idle) add(setup_step::idle);
    if (options.protection) add(setup_step::protection);
    add(setup_step::start);
  }

  unsigned left_ = 0;
  bool is_repeated_ = false;
};

/// The request of a step. An option that is not set any more has no request: nothing changes.
[[nodiscard]] request request_of(setup_step step, const lidar_options& options) noexcept;

/// Whether the device may have restarted before or during the step, and lost the settings of the steps
/// before it: an answer was lost, or the first start had no effect. A device that boots hears nothing.
[[nodiscard]] inline bool is_doubtful(setup_step step, const outcome& done) noexcept {
  if (step == setup_step::start) return done.starts > 1;
  if (step <= setup_step::health) return false;
  // A healthy device may refuse to step beyond its range.
  return done.retries > (step == setup_step::frequency ? done.wrong_answers : 0);
}

/// Whether the sequence fails if the step is not answered. Old firmware does not know every query.
[[nodiscard]] inline bool is_needed(setup_step step, const lidar_options& options) noexcept {
  return step != setup_step::health && (step != setup_step::ranging || options.ranging);
}

}  // namespace g4lidar
