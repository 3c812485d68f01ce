// SPDX-License-Identifier: MIT
// The stages of a live device: rounds, the calls of the program, the loss of the connection.
#include "live_driver.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "error_context.hpp"
#include "outcome_error.hpp"

namespace g4lidar {
namespace {

lidar_event::kind event_of(notice what) noexcept {
  switch (what) {
    case notice::found_scanning:
      return lidar_event::kind::found_scanning;
    case notice::protection_starved:
      return lidar_event::kind::protection_starved;
    case notice::protection_found_on:
      return lidar_event::kind::protection_found_on;
    case notice::spinning_up:
      return lidar_event::kind::spinning_up;
    default:
      return lidar_event::kind::restarted;
  }
}

}  // namespace

live_driver::live_driver(parts& of, const lidar_options& options)
    : scan_source(of, options),
      options_(options),
      stream_({connection_, pipeline_, receiver_, spin_up_, stage_, takes_points_}, options) {}

// ---- one round ----------------------------------------------------------------------------------

result<void> live_driver::advance(std::int64_t deadline_ns) {
  switch (stage_) {
    case live_stage::closed:
      return tl::unexpected(reconnection_.why());
    case live_stage::lost:
      if (!reconnection_.wait(connection_, deadline_ns)) return {};
      if (auto connected = connect(); !connected) return break_off(connected.error());
      if (auto served = serve(); !served) return break_off(served.error());
      return {};
    case live_stage::breaking:
      if (stream_.parse()) return {};
      pipeline_.end();
      stage_ = live_stage::broken;
      return {};
    case live_stage::broken:
      if (pipeline_.has_scan()) return {};
      return hang_up();
    default:
      break;
  }
  if (auto done = round(deadline_ns); !done) return break_off(done.error());
  if (const auto why = std::exchange(refused_, std::nullopt)) return tl::unexpected(*why);
  return {};
}

result<void> live_driver::round(std::int64_t deadline_ns) {
  stream_.follow_delivery();
  if (auto looked = stream_.look_if_due(); !looked) return looked;
  const auto has_outcome = serve();
  if (!has_outcome) return tl::unexpected(has_outcome.error());
  if (stream_.parse()) return {};
  // A caller that waits for an outcome gets it first.
  const std::int64_t until = *has_outcome ? now_ns() : std::min(deadline_ns, next_deadline_ns());
  if (auto got = stream_.receive(until); !got) return got;
  if (stream_.parse()) return {};
  if (stream_.reported().take_news()) {
    const auto& who = stream_.reported().who();
    if (information_.is_known() && who != information_) module_ = who;
  }
  // An event loop may not call again before bytes arrive: everything must be sent now.
  if (auto served = serve(); !served) return tl::unexpected(served.error());
  return {};
}

/// Handles the results of events: session events, the next step of the setup, commands. Returns
/// whether there was an outcome.
result<bool> live_driver::serve() {
  session& talk = stream_.talk();
  if (talk.has_nothing() && setup_.is_done()) return false;  // the usual case
  if (const notice what = talk.noticed(); what != notice::none) {
    if (what == notice::stalled) return tl::unexpected(stream_.silence_error());
    report(event_of(what));
    const bool is_reset = what == notice::restarted || what == notice::protection_found_on;
    if (is_reset && wants_scan_ && !set_up_again()) return tl::unexpected(stream_.silence_error());
    if (is_reset || what == notice::protection_starved) stream_.begin_points();
  }
  const auto has_outcome = go_on_with_setup();
  if (!has_outcome) return has_outcome;
  if (auto sent = stream_.send(); !sent) return tl::unexpected(sent.error());
  return has_outcome;
}

std::int64_t live_driver::next_deadline_ns() const noexcept {
  if (stage_ == live_stage::closed) return never_ns;
  if (stage_ == live_stage::lost) return reconnection_.next_attempt_ns();
  if (stage_ >= live_stage::breaking) return now_ns();
  const bool is_motor_due = setup_.starts_next() && !stream_.talk().is_busy();
  return is_motor_due ? std::min(stream_.next_deadline_ns(), stream_.motor_ready_ns())
                      : stream_.next_deadline_ns();
}

// ---- the connection -------------------------------------------------------------------------------

result<void> live_driver::connect() {
  if (auto opened = connection_.open(); !opened) return opened;
  stream_.begin();
  // The motor starts at an edge, and the system raises the line when it opens a port.
  if (auto lowered = stream_.set_motor(false); !lowered) return lowered;
  setup_.clear();
  setup_.reset_short_scans();  // the session has forgotten the scans before, too
  stage_ = live_stage::identifying;
  question_.forget_woken();
  setup_.add(setup_step::identify);
  return {};
}

/// The connection has broken, or is of no use. The bytes received so far are still processed.
result<void> live_driver::break_off(const error& broken) {
  reconnection_.lost(stream_.error_after(broken));
  if (stage_ <= live_stage::identifying) return hang_up();
  // The device will not be controlled any more. It may receive this stop, even if nothing is
  // received from it.
  for (const command each : {command::forced_stop, command::stop}) {
    if (reconnection_.why() == problem::gone || !connection_.send(encode(each))) break;
  }
  stream_.cut();
  stage_ = live_stage::breaking;
  return {};
}

/// Returns an error if waiting calls must know of it: not for a failed attempt to reconnect.
result<void> live_driver::hang_up() {
  const bool was_up = stage_ == live_stage::broken;
  if (!was_up) stream_.flush();
  connection_.close();
  setup_.clear();
  if (was_up) {
    report(lidar_event::kind::lost, reconnection_.why().code());
    reconnection_.begin();
  }
  if (!options_.reconnect || !information_.is_known()) {
    stage_ = live_stage::closed;
    return tl::unexpected(reconnection_.why());
  }
  stage_ = live_stage::lost;
  connection_.watch();
  reconnection_.plan(now_ns(), std::chrono::nanoseconds(options_.tuning.longest_backoff).count());
  if (was_up) return tl::unexpected(reconnection_.reconnecting());
  return {};
}

result<void> live_driver::can_read() const noexcept {
  if (stage_ == live_stage::closed) return tl::unexpected(reconnection_.why());
  if (wants_scan_) return {};
  return failure(task::reading, problem::not_scanning, connection_.name());
}

/// A lidar that is lost or being set up sends no scan. Both end by themselves, the setup by the times
/// of its requests.
scan_expectation live_driver::expects() const noexcept {
  if (stage_ == live_stage::closed || !wants_scan_) return {};
  if (stage_ == live_stage::scanning && stream_.talk().is_scanning()) {
    if (!spins_up()) return {};
    return {spin_up_.ends_ns(), error_detail::spinning_up};
  }
  const bool is_set_up = stage_ == live_stage::preparing || stage_ == live_stage::scanning;
  if (is_set_up && !reconnection_.is_under_way()) return {never_ns, error_detail::spinning_up};
  return {never_ns, error_detail::searching, reconnection_.why().subject()};
}

// ---- requests -----------------------------------------------------------------------------------

result<void> live_driver::open() {
  if (auto connected = connect(); !connected) return connected;
  return run_setup();
}

result<void> live_driver::start() {
  if (is_scanning()) return {};
  if (auto ready = run_setup(); !ready) return ready;
  const bool goes_on = stage_ == live_stage::scanning && stream_.talk().is_scanning();
  wants_scan_ = true;
  if (goes_on) return {};  // a start that was woken, and is complete now
  pipeline_.drop_scan();
  setup_.reset_short_scans();
  spin_up_.forget();
  stage_ = live_stage::preparing;
  question_.forget_woken();
  setup_.add_start(options_);
  const auto started = run_setup();
  // If it is woken, the next calls continue it, also next_scan().
  if (!started && started.error() != problem::cancelled) wants_scan_ = false;
  return started;
}

result<void> live_driver::stop() {
  wants_scan_ = false;
  if (stage_ == live_stage::lost) return {};  // it is stopped after the reconnect
  if (auto ready = run_setup(); !ready) return ready;
  pipeline_.drop_scan();
  // A stop that was woken has continued in other calls.
  if (std::exchange(stage_, live_stage::stopping) != live_stage::stopping) {
    question_.forget_woken();
    setup_.add(setup_step::stop);
  }
  if (auto stopped = run_setup(); !stopped) return stopped;
  stream_.flush();
  pipeline_.end();
  stage_ = live_stage::idle;
  return {};
}

void live_driver::release() noexcept {
  stream_.flush();
  pipeline_.drop_scan();
  connection_.close();
  setup_.clear();
  stage_ = live_stage::closed;
  reconnection_.lost(error(task::reading, problem::gone, "this lidar, which was closed"));
}

result<answer> live_driver::ask(const request& wanted, while_scanning how) {
  if (!question_.was_woken(wanted) || !stream_.talk().is_busy()) {
    question_.forget_woken();
    if (auto ready = run_setup(); !ready) return tl::unexpected(ready.error());
    if (const auto refused = stream_.talk().begin(wanted, now_ns(), how)) {
      return tl::unexpected(
          refusal_error(task::asking, *refused, wanted, *options_.model, connection_.name()));
    }
  }
  question_.begin(wanted);
  auto done = result<void>();
  while (done && question_.is_waiting()) {
    pipeline_.drop_scan();
    done = step(never_ns);
  }
  const bool is_woken = !done && done.error() == problem::cancelled;
  if (is_woken && question_.is_waiting()) {
    question_.leave();
    return tl::unexpected(done.error());
  }
  const auto found = question_.end();
  if (!found || (!done && !is_woken)) return tl::unexpected(done.error());
  if (is_woken) connection_.wake_next_call();  // this call has its answer
  if (found->how != verdict::answered) {
    return tl::unexpected(stream_.error_after(error_of(*found, stage_, connection_.name())));
  }
  if (!setup_.is_done()) {  // after a restart
    const auto ready = run_setup();
    const bool wakes = !ready && ready.error() == problem::cancelled;
    if (!ready && !wakes) return tl::unexpected(ready.error());
    if (wakes) connection_.wake_next_call();  // the next call continues it
  }
  return found->value;
}

void live_driver::add_to(lidar_counts& counts) const noexcept {
  counts.command_retries = stream_.talk().retries();
  counts.reconnects = reconnection_.count();
}

}  // namespace g4lidar
