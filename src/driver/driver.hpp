// SPDX-License-Identifier: MIT
// The implementation of a lidar: its parts, and the calls that return their results.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "core/time_limit.hpp"
#include "g4lidar/lidar.hpp"
#include "scan_source.hpp"

namespace g4lidar {

/// *Single thread* except wake(). The calls are loops over the steps of the source of the scans.
class G4LIDAR_HIDDEN lidar::driver {
 public:
  driver(std::unique_ptr<connector> connector, const lidar_options& options,
         const g4lidar::recognition& known);
  driver(const driver&) = delete;
  driver& operator=(const driver&) = delete;
  ~driver();

  result<void> open();
  result<void> start() { return source_->start(); }
  result<void> stop() { return source_->stop(); }
  result<void> close();
  void release() noexcept;
  result<answer> ask(const request& wanted, while_scanning if_scanning) {
    return source_->ask(wanted, if_scanning);
  }
  /// Nothing at `until_ns()`, which each step asks; errors for which `goes_on` is true do not end it.
  template <class Until, class GoesOn>
  result<std::optional<scan>> read_scan(const Until& until_ns, const GoesOn& goes_on);
  result<std::span<const point>> next_points(milliseconds timeout);

  [[nodiscard]] const scan_source& source() const noexcept { return *source_; }
  /// The error of a call that waited for a scan, or for any points.
  [[nodiscard]] tl::unexpected<error> timed_out(bool wants_scan = true) const noexcept {
    scan_expectation now = source_->expects();
    if (!wants_scan && now.why == error_detail::no_revolution) now.why = error_detail::usual;
    return failure(task::reading, problem::timeout, now.lost.empty() ? name() : now.lost, 0,
                   now.why);
  }
  result<void> process();
  void wake() noexcept { parts_.link.wake(); }

  [[nodiscard]] int native_handle() const noexcept { return parts_.link.native_handle(); }
  /// After this call, native_handle() reports no bytes that are not needed yet.
  [[nodiscard]] std::int64_t next_deadline_ns() noexcept {
    const std::int64_t due_ns = source_->next_deadline_ns();
    const std::int64_t rest_ns = source_->rest_until_ns();
    const bool rests = rest_ns > parts_.link.now_ns();
    parts_.link.rest(rests);
    return rests ? std::min(due_ns, rest_ns) : due_ns;
  }
  [[nodiscard]] g4lidar::player* player() noexcept { return source_->controls(); }
  [[nodiscard]] const device_information& information() const noexcept {
    return source_->information();
  }
  [[nodiscard]] std::optional<device_information> module_information() const noexcept {
    return source_->module_information();
  }
  [[nodiscard]] g4lidar::recognition recognition() const noexcept {
    return parts_.recognised.get();
  }
  [[nodiscard]] std::string_view name() const noexcept { return parts_.link.name(); }
  [[nodiscard]] bool is_scanning() const noexcept { return source_->is_scanning(); }
  [[nodiscard]] lidar_counts counts() const noexcept;
  [[nodiscard]] std::optional<lidar_event> next_event() noexcept { return parts_.events.take(); }
  [[nodiscard]] lidar_ring& points() noexcept {
    source_->take_points();
    return parts_.pipeline.ring();
  }

 private:
  /// The connection was released: no points come any more.
  void drop_points() noexcept;
  /// Whether a call ends after its last step: at its end by source_->caller_ns().
  [[nodiscard]] bool is_over(std::int64_t deadline_ns) const noexcept {
    return (source_->caller_ns() >= deadline_ns || source_->stands()) && parts_.pipeline.is_empty();
  }

  scan_source::parts parts_;
  std::unique_ptr<scan_source> source_;
  point_storage points_;
  bool hands_points_over_ = false;  // by next_points()
  std::uint64_t points_missed_ = 0;
};

/// The end of a call, by the clock of the timeouts of calls.
[[nodiscard]] inline std::int64_t deadline_after_ns(const scan_source& source,
                                                    lidar::milliseconds timeout) noexcept {
  return source.deadline_after_ns(limited_ns(timeout));
}
/// From now until such a time: 0 if it is over; milliseconds::max() for never_ns.
[[nodiscard]] inline lidar::milliseconds time_until(const scan_source& source,
                                                    std::int64_t at_ns) noexcept {
  if (at_ns == never_ns) return lidar::milliseconds::max();
  const std::chrono::nanoseconds left(at_ns - source.caller_ns());
  return std::max(std::chrono::ceil<lidar::milliseconds>(left), lidar::milliseconds(0));
}

template <class Until, class GoesOn>
result<std::optional<scan>> lidar::driver::read_scan(const Until& until_ns, const GoesOn& goes_on) {
  point_pipeline& pipeline = parts_.pipeline;
  if (!pipeline.has_scan()) {
    if (auto able = source_->can_read(); !able) return tl::unexpected(able.error());
  }
  bool last = false;
  while (!pipeline.has_scan()) {
    if (last) return std::nullopt;
    const auto done = source_->step(source_->step_until_ns(until_ns()));
    if (!done && !goes_on(done.error())) return tl::unexpected(done.error());
    last = is_over(until_ns());
  }
  return pipeline.take_scan();
}

/// The results of a moved-from lidar or reader.
[[nodiscard]] inline tl::unexpected<error> moved_from() noexcept {
  return failure(task::reading, problem::gone, "this lidar, which was moved from");
}

/// A ring that is never written to. Not const: then it takes no space in the program file.
[[nodiscard]] inline const lidar_ring& empty_ring() noexcept {
  static constinit std::array<lidar_ring::slot, 2> slots;
  static constinit lidar_ring ring{slots};
  return ring;
}

}  // namespace g4lidar
