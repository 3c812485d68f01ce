// SPDX-License-Identifier: MIT
// The stages of a live device: rounds, the calls of the program, the loss of the connection.
#include "live_driver.hpp"

#include <algorithm>
#include <utility>

#include "driver/error_context.hpp"
#include "driver/outcome_error.hpp"

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

// ---- one round ----------------------------------------------------------------------------------

result<void> live_driver::round(std::int64_t deadline_ns) {
  stream_.follow_delivery();
  if (auto looked = stream_.look_if_due(); !looked) return looked;
  const auto has_outcome = serve();
  if (!has_outcome) return tl::unexpected(has_outcome.error());
  if (stream_.parse()) return {};
  // A caller that waits for an outcome gets it first.
  const std::int64_t until = *has_outcome ? now_ns() : std::min(deadline_ns, due_ns());
  if (auto got = stream_.receive(until); !got) return got;
  if (stream_.parse()) return {};
  if (auto same = follow_samples(); !same) return same;
  if (stream_.reported().take_news()) {
    const auto& who = stream_.reported().who();
    if (information_.is_known() && who != information_) recognised_.module = who;
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
    if (what == notice::stalled) return tl::unexpected(silence_error());
    // Whole packets of another size are no packets of the session.
    const bool is_apparent = what == notice::spinning_up && pipeline_.input().has_other_size();
    if (!is_apparent) report(event_of(what));
    if (what == notice::found_scanning) listening_ = {};
    const bool is_reset = what == notice::restarted || what == notice::protection_found_on;
    if (is_reset && wants_scan_ && !set_up_again()) return tl::unexpected(silence_error());
    if (is_reset || what == notice::protection_starved) stream_.begin_points();
  }
  const auto has_outcome = go_on_with_setup();
  if (!has_outcome) return has_outcome;
  if (auto sent = stream_.send(); !sent) return tl::unexpected(sent.error());
  return has_outcome;
}

/// Of a device that has ended a scan and does not continue.
error live_driver::silence_error() const {
  constexpr std::uint64_t of_boot_texts = 1000;
  const std::uint64_t skipped = pipeline_.counts().stream.skipped_bytes() - skipped_at_begin_;
  if (skipped > of_boot_texts) return without_packets(connection_, skipped);
  if (pipeline_.counts().scans > scans_at_begin_)
    return {task::reading, problem::stalled, connection_.name()};
  const bool is_by_line = options_.model->motor == motor_kind::dtr;
  const auto why = is_by_line ? error_detail::motor_line : error_detail::usual;
  return {task::starting, problem::brown_out, connection_.name(), 0, why};
}

/// A device that scans is noticed before anything is sent: one that obeys at once is not noticed afterwards.
bool live_driver::listens() const noexcept {
  return now_ns() < listening_.until_ns(pipeline_.input());
}

std::int64_t live_driver::due_ns() const noexcept {
  if (listens())
    return std::min(stream_.next_deadline_ns(), listening_.until_ns(pipeline_.input()));
  const bool is_motor_due = setup_.starts_next() && !stream_.talk().is_busy();
  return is_motor_due ? std::min(stream_.next_deadline_ns(), stream_.motor_ready_ns())
                      : stream_.next_deadline_ns();
}

// ---- the connection -------------------------------------------------------------------------------

result<void> live_driver::connected() {
  const bool was_heard = is_recognised_ || connection_.port_connector().traits().is_searched;
  listening_ = {was_heard ? 0 : now_ns(), pipeline_.input().bytes_parsed()};
  setup_.reset_short_scans();  // the session has forgotten the scans before, too
  question_.forget_woken();
  setup_.add(setup_step::identify);
  const auto served = serve();
  return served ? result<void>() : tl::unexpected(served.error());
}

/// Nothing would stop the motor later. The device may receive this stop, even if nothing is received
/// from it.
void live_driver::leave() noexcept {
  setup_.clear();
  if (stage_ <= live_stage::identifying) return;
  for (const command each : {command::forced_stop, command::stop}) {
    if (reconnection_.why() == problem::gone || !connection_.send(encode(each))) break;
  }
}

// ---- requests -----------------------------------------------------------------------------------

result<void> live_driver::start() {
  if (is_scanning()) return {};
  if (auto ready = settle(); !ready) return ready;
  const bool goes_on = stage_ == live_stage::scanning && stream_.talk().is_scanning();
  wants_scan_ = true;
  if (goes_on) return {};  // a start that was woken, and is complete now
  pipeline_.drop_scan();
  setup_.reset_short_scans();
  spin_up_.forget();
  stage_ = live_stage::preparing;
  question_.forget_woken();
  setup_.add_start(options_);
  const auto started = settle();
  // If it is woken, the next calls continue it, also try_scan().
  if (!started && started.error() != problem::cancelled) wants_scan_ = false;
  return started;
}

result<void> live_driver::stop() {
  wants_scan_ = false;
  if (stage_ == live_stage::lost) return {};  // it is stopped after the reconnect
  if (auto ready = settle(); !ready) return ready;
  pipeline_.drop_scan();
  // A stop that was woken has continued in other calls.
  if (std::exchange(stage_, live_stage::stopping) != live_stage::stopping) {
    question_.forget_woken();
    setup_.add(setup_step::stop);
  }
  if (auto stopped = settle(); !stopped) return stopped;
  stream_.flush();
  pipeline_.end();
  stage_ = live_stage::idle;
  return {};
}

result<answer> live_driver::ask(const request& wanted, while_scanning if_scanning) {
  if (!question_.was_woken(wanted) || !stream_.talk().is_busy()) {
    question_.forget_woken();
    if (auto ready = settle(); !ready) return tl::unexpected(ready.error());
    stream_.heard() = {};
    if (const auto refused = stream_.talk().begin(wanted, now_ns(), if_scanning)) {
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
    return tl::unexpected(stream_.error_after(
        error_of(*found, stage_, connection_, *options_.model, stream_.heard())));
  }
  if (!setup_.is_done()) {  // after a restart
    const auto ready = settle();
    const bool wakes = !ready && ready.error() == problem::cancelled;
    if (!ready && !wakes) return tl::unexpected(ready.error());
    if (wakes) connection_.wake_next_call();  // the next call continues it
  }
  return found->value;
}

}  // namespace g4lidar
