// SPDX-License-Identifier: MIT
// The source of the bytes of a lidar: a live device or a recording.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "event_queue.hpp"
#include "g4lidar/core/session.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/recording/contents.hpp"
#include "g4lidar/recording/player.hpp"
#include "kept_recognition.hpp"
#include "link/connection.hpp"
#include "point_pipeline.hpp"
#include "receiver.hpp"
#include "spin_up.hpp"

namespace g4lidar {

/// What a caller that waits for a scan can expect.
struct scan_expectation {
  /// The time, by caller_ns(), before which no scan need come, so that a loop over scans waits until then
  /// at least; 0 if one is due.
  std::int64_t not_due_before_ns = 0;
  error_detail why = error_detail::usual;  ///< Of the error of a call that ends without a scan.
  std::string_view lost{};                 ///< What is looked for; valid until it is found.
};

/// Why a scan that is due has not come: packets of it have come in the last moments, or nothing.
[[nodiscard]] inline error_detail why_not_yet(const point_pipeline& pipeline,
                                              std::int64_t now_ns) noexcept {
  constexpr std::int64_t longest_gap_ns = 200'000'000;  // with the largest batch
  const std::int64_t last_ns = pipeline.decoder().last_packet_ns();
  const bool is_moving = last_ns != 0 && now_ns - last_ns < longest_gap_ns;
  return is_moving ? error_detail::no_revolution : error_detail::usual;
}

/// *Single thread.* The pipeline, the connection and the events must outlive it.
class scan_source {
 public:
  /// The parts that it works on.
  struct parts {
    connection link;
    point_pipeline pipeline;
    event_queue events;
    kept_recognition recognised;
  };

  scan_source(parts& used, const lidar_options& options)
      : connection_(used.link),
        pipeline_(used.pipeline),
        events_(used.events),
        recognised_(used.recognised),
        receiver_(options.tuning.batch, *options.model) {}
  virtual ~scan_source() = default;
  scan_source(const scan_source&) = delete;
  scan_source& operator=(const scan_source&) = delete;

  [[nodiscard]] virtual result<void> open() = 0;
  [[nodiscard]] virtual result<void> start() = 0;
  [[nodiscard]] virtual result<void> stop() = 0;
  [[nodiscard]] virtual result<answer> ask(const request& wanted, while_scanning if_scanning) = 0;
  /// From now on each packet is wanted when it is complete, not only whole scans. *Any thread.*
  void take_points() noexcept { takes_points_.store(true, std::memory_order_relaxed); }
  /// Releases the connection, and leaves the device as it is; `rests`: except a motor that the host's port
  /// drives, which stops.
  virtual void release(bool rests) noexcept = 0;

  /// Does everything that is due, and waits for bytes until the deadline at most once. Stops at a
  /// scan. A woken call has made progress, so that calls that are woken repeatedly complete. If
  /// this returns an error that ends the scan, all scans and points were delivered before.
  [[nodiscard]] result<void> step(std::int64_t deadline_ns) {
    auto done = advance(connection_.is_woken() ? connection_.now_ns() : deadline_ns);
    const bool is_cancelled = !done && done.error() == problem::cancelled;
    if ((done || is_cancelled) && connection_.take_wake()) {
      return failure(task::reading, problem::cancelled, connection_.name());
    }
    return done;
  }

  /// Why nothing can be read, if so.
  [[nodiscard]] virtual result<void> can_read() const noexcept = 0;
  [[nodiscard]] virtual scan_expectation expects() const noexcept = 0;
  /// Whether a scan is running or being set up.
  [[nodiscard]] virtual bool has_motor_on() const noexcept = 0;
  [[nodiscard]] virtual bool is_scanning() const noexcept = 0;
  [[nodiscard]] virtual std::int64_t next_deadline_ns() const noexcept = 0;
  /// The time until which bytes need not be read; may be in the past.
  [[nodiscard]] virtual std::int64_t rest_until_ns() const noexcept { return 0; }
  /// The clock of the timeouts of calls: not that of a file that is played.
  [[nodiscard]] virtual std::int64_t caller_ns() const noexcept { return now_ns(); }
  /// The end of a call that waits for this time, by caller_ns().
  [[nodiscard]] virtual std::int64_t deadline_after_ns(std::int64_t timeout_ns) const noexcept {
    return detail::saturating_add(now_ns(), timeout_ns);
  }
  /// Such an end by the clock of step(), as it goes now.
  [[nodiscard]] virtual std::int64_t step_until_ns(std::int64_t deadline_ns) const noexcept {
    return deadline_ns;
  }
  [[nodiscard]] const device_information& information() const noexcept { return information_; }
  /// Of the turning part, if it has reported another one.
  [[nodiscard]] const std::optional<device_information>& module_information() const noexcept {
    return recognised_.module;
  }
  /// Of a file that is played; else null.
  [[nodiscard]] virtual player* controls() noexcept { return nullptr; }
  /// Whether no step makes progress: a wait of it ends a call.
  [[nodiscard]] virtual bool stands() const noexcept { return false; }
  /// Adds the counts that do not belong to the pipeline.
  virtual void add_to(lidar_counts& counts) const noexcept = 0;

 protected:
  [[nodiscard]] virtual result<void> advance(std::int64_t deadline_ns) = 0;

  [[nodiscard]] std::int64_t now_ns() const noexcept { return connection_.now_ns(); }
  void report(lidar_event::kind kind, problem reason = problem::timeout) noexcept {
    events_.put({kind, reason, now_ns()});
    if (kind == lidar_event::kind::other_number) recognised_.record(connection_.port_connector());
  }

  /// The motor is started: the first scan comes when it has spun up.
  void begin_spin_up() noexcept {
    spin_up_.begin(deadline_after_ns(spin_up::longest_ns), pipeline_.counts().scans);
  }

  connection& connection_;
  point_pipeline& pipeline_;
  event_queue& events_;
  kept_recognition& recognised_;
  std::atomic<bool> takes_points_ = false;
  receiver receiver_;
  spin_up spin_up_;
  device_information information_{};
};

}  // namespace g4lidar
