// SPDX-License-Identifier: MIT
// The connection of a live device: opened, lost, and opened again.
#include <algorithm>
#include <chrono>
#include <utility>

#include "error_context.hpp"
#include "live_driver.hpp"
#include "transport/port_holder.hpp"

namespace g4lidar {

result<void> live_driver::connect() {
  if (auto opened = connection_.open(); !opened) return opened;
  session_.reset();
  const transport& on = connection_.on();
  receiver_.reset(on.baud(), on.kept_bytes(), now_ns());
  pipeline_.follow(connection_.on().baud());
  setup_.clear();
  setup_.reset_short_scans();  // the session has forgotten the scans before, too
  spin_up_.forget();
  stage_ = stage::identifying;
  record(recorded_event::kind::held);
  add_step(setup_step::identify);
  return {};
}

result<void> live_driver::wait_for_return(std::int64_t deadline_ns) {
  if (now_ns() < reconnection_.next_attempt_ns()) {
    connection_.pause(std::min(deadline_ns, reconnection_.next_attempt_ns()));
    if (connection_.from().may_be_back()) reconnection_.retry_now(now_ns());
    if (now_ns() < reconnection_.next_attempt_ns()) return {};
  }
  if (auto connected = connect(); !connected) return break_off(connected.error());
  if (auto served = serve(); !served) return break_off(served.error());
  return {};
}

/// The connection has broken, or is of no use. The bytes received so far are still processed.
result<void> live_driver::break_off(const error& broken) {
  lost_ = error_after(broken);
  if (stage_ <= stage::identifying) return hang_up();
  leave_stopped(lost_);
  cut();
  stage_ = stage::breaking;
  return {};
}

/// The device will not be controlled any more. It may receive this stop, even if nothing is
/// received from it.
void live_driver::leave_stopped(const error& why) noexcept {
  if (why == problem::gone) return;
  for (const command each : {command::forced_stop, command::stop}) {
    if (!connection_.send(encode(each))) return;
  }
}

/// Returns an error if waiting calls must know of it: not for a failed attempt to reconnect.
result<void> live_driver::hang_up() {
  const bool was_up = stage_ == stage::broken;
  if (!was_up) flush();
  connection_.close();
  setup_.clear();
  if (was_up) {
    report(lidar_event::kind::lost, lost_.code());
    reconnection_.begin();
  }
  if (!options_.reconnect || !is_known()) {
    stage_ = stage::closed;
    return tl::unexpected(lost_);
  }
  stage_ = stage::lost;
  connection_.watch();
  reconnection_.plan(now_ns(), std::chrono::nanoseconds(options_.tuning.longest_backoff).count());
  if (was_up) return tl::unexpected(unavailable());
  return {};
}

/// Decodes the received bytes. Scans that are completed here are not taken.
void live_driver::flush() {
  if (!connection_.is_open()) return;
  pipeline_.drop_scan();
  cut();
  while (parse_bytes()) pipeline_.drop_scan();
}

/// Why nothing can be sent or read now.
error live_driver::unavailable() const {
  if (stage_ == stage::closed) return lost_;
  const error_context about = error_context(lost_.subject()).add(", ").add(name_of(lost_.code()));
  return {task::reading, problem::reconnecting, about};
}

result<void> live_driver::can_read() const noexcept {
  if (stage_ == stage::closed) return tl::unexpected(lost_);
  if (wants_scan_) return {};
  return failure(task::reading, problem::not_scanning, connection_.name());
}

/// A lidar that is lost or being set up sends no scan. Both end by themselves, the setup by the times
/// of its requests.
scan_expectation live_driver::expects() const noexcept {
  if (stage_ == stage::closed || !wants_scan_) return {};
  if (stage_ == stage::scanning && session_.is_scanning()) {
    if (!spins_up()) return {};
    return {spin_up_.ends_ns(), error_detail::spinning_up};
  }
  const bool is_set_up = stage_ == stage::preparing || stage_ == stage::scanning;
  if (is_set_up && !reconnection_.is_under_way()) return {never_ns, error_detail::spinning_up};
  return {never_ns, error_detail::searching, lost_.subject()};
}

/// Another process on the port explains more than its effects.
error live_driver::error_after(const error& why) const {
  return connection_.is_open() ? with_port_conflict(why, connection_.on()) : why;
}

}  // namespace g4lidar
