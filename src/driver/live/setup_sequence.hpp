// SPDX-License-Identifier: MIT
// The commands to a device before it scans, and their order.
#pragma once

#include <bit>
#include <cstdint>
#include <utility>

#include "g4lidar/core/request.hpp"
#include "g4lidar/lidar.hpp"

namespace g4lidar {

/// The steps, in their order.
enum class setup_step : std::uint8_t {
  identify,
  stop,
  health,
  zero_angle,
  sample_rate,
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
  /// Everything again, because the device ended a scan of this length by itself and may have lost
  /// its settings. False if this has happened too often in succession.
  [[nodiscard]] bool begin_again(const lidar_options& options, std::int64_t length_ns) noexcept {
    const bool is_short = length_ns < long_scan_ns;
    if (is_short && short_scans_ >= (length_ns > 0 ? max_short : max_silent)) return false;
    short_scans_ = is_short ? short_scans_ + 1 : 1;
    clear();
    is_again_ = true;
    add(setup_step::stop);
    add_start(options);
    return true;
  }
  /// Whether begin_again() was called for the steps, until clear().
  [[nodiscard]] bool is_again() const noexcept { return is_again_; }
  /// The earlier calls of begin_again() do not count any more.
  void reset_short_scans() noexcept { short_scans_ = 0; }
  void clear() noexcept {
    left_ = 0;
    is_again_ = false;
  }

  [[nodiscard]] bool is_done() const noexcept { return left_ == 0; }
  /// The first remaining step; only if not is_done().
  [[nodiscard]] setup_step next() const noexcept {
    return static_cast<setup_step>(std::countr_zero(left_));
  }
  /// Whether next() is the start.
  [[nodiscard]] bool starts_next() const noexcept {
    return !is_done() && next() == setup_step::start;
  }
  /// Removes next().
  void finish_next() noexcept { left_ &= left_ - 1U; }

 private:
  /// The limit of consecutive setups of a device whose scans are shorter than this, or that sends no
  /// packet.
  static constexpr int max_short = 3;
  static constexpr int max_silent = 1;
  static constexpr std::int64_t long_scan_ns = 6'000'000'000;

  [[nodiscard]] static unsigned bit(setup_step step) noexcept {
    return 1U << static_cast<unsigned>(step);
  }
  void add_steps(const lidar_options& options) noexcept {
    add(setup_step::health);
    const model& which = options.model != nullptr ? *options.model : g4_model;
    if (has_request(which, request_kind::zero_angle) && !options.zero_angle) {
      add(setup_step::zero_angle);
    }
    // Queried if it is not set.
    const bool has_rate = has_request(which, request_kind::get_sample_rate);
    if (has_rate || options.sample_rate) add(setup_step::sample_rate);
    if (options.frequency) add(setup_step::frequency);
    if (options.direction) add(setup_step::direction);
    if (options.constant) add(setup_step::constant);
    if (options.idle) add(setup_step::idle);
    if (options.protection) add(setup_step::protection);
    add(setup_step::start);
  }

  unsigned left_ = 0;
  bool is_repeated_ = false;
  bool is_again_ = false;
  int short_scans_ = 0;  // setups after them
};

/// The request of a step. An option that is not set any more has no request: nothing changes.
[[nodiscard]] inline request request_of(setup_step step, const lidar_options& options) noexcept {
  const auto set = [](const auto& option, request otherwise) {
    return option ? requests::set(*option) : otherwise;
  };
  switch (step) {
    case setup_step::identify:
      return requests::device_info();
    case setup_step::stop:
      return requests::stop();
    case setup_step::health:
      return requests::health();
    case setup_step::zero_angle:
      return requests::zero_angle();
    case setup_step::sample_rate:
      return set(options.sample_rate, requests::get_sample_rate());
    case setup_step::frequency:
      return set(options.frequency, requests::get_scan_frequency());
    case setup_step::direction:
      return set(options.direction, requests::get_direction());
    case setup_step::constant:
      return set(options.constant, requests::health());
    case setup_step::idle:
      return set(options.idle, requests::get_low_power());
    case setup_step::protection:
      return set(options.protection, requests::health());
    case setup_step::start:
      break;
  }
  return requests::start();
}

/// Whether the device may have restarted before or during the step, and lost the settings of the steps
/// before it: an answer was lost, or the first start had no effect. A device that boots hears nothing.
[[nodiscard]] inline bool is_doubtful(setup_step step, const outcome& done) noexcept {
  if (step == setup_step::start) return done.starts > 1;
  if (step <= setup_step::zero_angle) return false;
  // A healthy device may refuse to step beyond its range.
  return done.retries > (step == setup_step::frequency ? done.wrong_answers : 0);
}

/// Whether the sequence fails if the step is not answered. Old firmware does not know every query.
[[nodiscard]] inline bool is_needed(setup_step step, const lidar_options& options) noexcept {
  const bool is_query = step == setup_step::health || step == setup_step::zero_angle ||
                        (step == setup_step::sample_rate && !options.sample_rate);
  return !is_query;
}

}  // namespace g4lidar
