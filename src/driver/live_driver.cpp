// SPDX-License-Identifier: MIT
// The rounds of a live device: read bytes, handle events, pass the time, send commands. And its
// requests.
#include "live_driver.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/saturating.hpp"
#include "error_context.hpp"

namespace g4lidar {
namespace {

/// A device that has been silent for this time will not continue an unfinished packet. Bridges hold
/// bytes back for up to 16 ms.
constexpr std::int64_t cut_off_after_ns = 30'000'000;

session_times times_for(const lidar_options& options) noexcept {
  session_times times;
  times.answer_ns = std::chrono::nanoseconds(options.tuning.answer_time).count();
  times.stall_ns = std::chrono::nanoseconds(options.tuning.stall_time).count();
  return times;
}

}  // namespace

live_driver::live_driver(parts& of, const lidar_options& options)
    : feeder(of, options), options_(options), session_(times_for(options)) {}

// ---- one round ----------------------------------------------------------------------------------

result<void> live_driver::advance(std::int64_t deadline_ns) {
  switch (stage_) {
    case stage::closed:
      return tl::unexpected(lost_);
    case stage::lost:
      return wait_for_return(deadline_ns);
    case stage::breaking:
      if (digest()) return {};
      pipeline_.end();
      stage_ = stage::broken;
      return {};
    case stage::broken:
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
  follow_delivery();
  if (auto looked = look_if_due(); !looked) return looked;
  const auto has_outcome = serve();
  if (!has_outcome) return tl::unexpected(has_outcome.error());
  if (digest()) return {};
  // A caller that waits for an outcome gets it first.
  const std::int64_t until = *has_outcome ? now_ns() : std::min(deadline_ns, next_deadline_ns());
  if (auto got = receive(until); !got) return got;
  if (pipeline_.unparsed().empty() && is_cut_off()) cut();
  if (digest()) return {};
  // An event loop may not call again before bytes arrive: everything must be sent now.
  if (auto served = serve(); !served) return tl::unexpected(served.error());
  return {};
}

/// Handles the results of events: session events, the next step of the setup, commands. Returns
/// whether there was an outcome.
result<bool> live_driver::serve() {
  if (session_.has_nothing() && setup_.is_done()) return false;  // the usual case
  if (auto done = take_notice(); !done) return tl::unexpected(done.error());
  const auto has_outcome = go_on_with_setup();
  if (!has_outcome) return has_outcome;
  if (auto sent = send_commands(); !sent) return tl::unexpected(sent.error());
  return has_outcome;
}

result<void> live_driver::send_commands() {
  while (const auto command = session_.to_send()) {
    if (auto sent = connection_.send(*command); !sent) return sent;
  }
  return {};
}

/// Passes the time to the session, when it is due. Bytes that arrived while the program was
/// suspended are processed before that.
result<void> live_driver::look_if_due() {
  const std::int64_t due_ns = session_.next_look_ns();
  if (!pipeline_.unparsed().empty() || due_ns > now_ns()) return {};
  if (receiver_.read_until_ns() < due_ns) {
    if (auto got = receive(now_ns()); !got) return got;
    if (!pipeline_.unparsed().empty()) return {};
  }
  if (is_cut_off()) {
    pipeline_.drop_scan();
    cut();
    if (digest()) return {};  // look() follows in the next round
  }
  session_.look(now_ns());
  return {};
}

/// The device does not continue a packet after such a pause. The held bytes are parsed again, before
/// the next answer is taken for the rest of the packet.
bool live_driver::is_cut_off() const noexcept {
  return is_waiting_for_answer() && pipeline_.held() > 0 &&
         now_ns() - receiver_.last_bytes_ns() >= cut_off_after_ns;
}

result<void> live_driver::receive(std::int64_t deadline_ns) {
  const auto got = receiver_.receive(connection_.on(), how_to_read(), pipeline_.held(),
                                     pipeline_.missing(), deadline_ns);
  if (!got) return tl::unexpected(got.error());
  if (got->count > 0) pipeline_.feed(receiver_.buffer(got->count), got->arrival_ns);
  return {};
}

reading live_driver::how_to_read() const noexcept {
  if (stage_ != stage::scanning) return reading::at_once;
  if (receiver_.is_batched()) return reading::batched;
  if (is_waiting_for_answer()) return reading::at_once;
  const bool by_packets = options_.tuning.pace == read_pace::automatic
                              ? takes_points_.load(std::memory_order_relaxed)
                              : options_.tuning.pace == read_pace::packets;
  return by_packets ? reading::paced : reading::scans;
}

/// Parses until there is a scan (true), or until nothing is left.
bool live_driver::digest() {
  while (!pipeline_.find_scan()) {
    const event* const found = pipeline_.next();
    if (found == nullptr) return false;
    session_.take(*found, pipeline_.arrival_ns());
    follow_delivery();
    const auto* const packet = std::get_if<packet_view>(found);
    if (packet != nullptr && pipeline_.delivers()) {
      const double period_ns = pipeline_.period_ns();
      const auto way_ns = static_cast<double>(packet->sample_count() - 1) * period_ns;
      receiver_.packet(*packet, pipeline_.unparsed().size(),
                       pipeline_.next_sample_ns() + static_cast<std::int64_t>(way_ns), period_ns);
    }
  }
  return true;
}

/// Packets of a device that is being stopped are discarded. A scan that continues after any
/// interruption begins a new stream of points.
void live_driver::follow_delivery() {
  const bool may_begin = stage_ >= stage::preparing && stage_ != stage::stopping;
  const bool wanted =
      session_.is_scanning() && (may_begin || (stage_ == stage::stopping && pipeline_.delivers()));
  if (wanted == pipeline_.delivers()) return;
  pipeline_.deliver(wanted);
  if (wanted) {
    begin_points();
  } else {
    record(recorded_event::kind::held);
  }
}

void live_driver::begin_points() {
  begin_spin_up();
  pipeline_.begin(samples_per_second_);
  record(recorded_event::kind::begun);
}

void live_driver::cut() {
  record(recorded_event::kind::cut);
  pipeline_.cut();
}

/// For a recording. A place is defined by the unparsed rest of the last read and by the number of
/// events from it: both are the same when the same bytes are read again.
void live_driver::record(recorded_event::kind what) {
  recording_hook* const recorder = recording_hook_of(connection_.from());
  if (recorder == nullptr || !connection_.is_open()) return;
  recorded_event made{.what = what, .time_ns = now_ns()};
  made.delivers = pipeline_.delivers();
  made.baud = connection_.on().baud();
  made.samples_per_second = samples_per_second_;
  made.unparsed = static_cast<std::uint32_t>(pipeline_.unparsed().size());
  made.events = pipeline_.events_of_reading();
  recorder->event(made);
}

result<void> live_driver::take_notice() {
  switch (session_.noticed()) {
    case notice::none:
      return {};
    case notice::found_scanning:
      report(lidar_event::kind::found_scanning);
      return {};
    case notice::protection_starved:
      report(lidar_event::kind::protection_starved);
      break;
    case notice::protection_found_on:
      report(lidar_event::kind::protection_found_on);
      if (wants_scan_ && !set_up_again()) return tl::unexpected(silence_error());
      break;
    case notice::spinning_up:
      report(lidar_event::kind::spinning_up);
      return {};
    case notice::restarted:
      report(lidar_event::kind::restarted);
      if (wants_scan_ && !set_up_again()) return tl::unexpected(silence_error());
      break;
    case notice::stalled:
      return tl::unexpected(silence_error());
  }
  begin_points();
  return {};
}

std::int64_t live_driver::next_deadline_ns() const noexcept {
  if (stage_ == stage::closed) return never_ns;
  if (stage_ == stage::lost) return reconnection_.next_attempt_ns();
  if (stage_ >= stage::breaking || !pipeline_.is_empty() || !session_.has_nothing())
    return now_ns();
  std::int64_t next = session_.next_look_ns();
  if (is_waiting_for_answer() && pipeline_.held() > 0) {
    next = std::min(next, receiver_.last_bytes_ns() + cut_off_after_ns);
  }
  return next;
}

/// An event loop that takes points is woken by each byte.
std::int64_t live_driver::rest_until_ns() const noexcept {
  const reading how = how_to_read();
  if (how != reading::scans && how != reading::batched) return 0;
  return receiver_.again_ns(how, pipeline_.held(), pipeline_.missing());
}

std::int64_t live_driver::deadline_after_ns(std::int64_t timeout_ns) const noexcept {
  return saturating_add(now_ns(), timeout_ns);
}

// ---- requests --------------------------------------------------------------------------------

result<void> live_driver::open() {
  if (auto connected = connect(); !connected) return connected;
  return run_setup();
}

result<void> live_driver::start() {
  if (is_scanning()) return {};
  if (auto ready = run_setup(); !ready) return ready;
  const bool goes_on = stage_ == stage::scanning && session_.is_scanning();
  wants_scan_ = true;
  if (goes_on) return {};  // a start that was woken, and is complete now
  pipeline_.drop_scan();
  setup_.reset_short_scans();
  spin_up_.forget();
  add_start();
  const auto started = run_setup();
  // If it is woken, the next calls continue it, also next_scan().
  if (!started && started.error() != problem::cancelled) wants_scan_ = false;
  return started;
}

result<void> live_driver::stop() {
  wants_scan_ = false;
  if (stage_ == stage::lost) return {};  // it is stopped after the reconnect
  if (auto ready = run_setup(); !ready) return ready;
  pipeline_.drop_scan();
  // A stop that was woken has continued in other calls.
  if (std::exchange(stage_, stage::stopping) != stage::stopping) add_step(setup_step::stop);
  if (auto stopped = run_setup(); !stopped) return stopped;
  flush();
  pipeline_.end();
  stage_ = stage::idle;
  return {};
}

void live_driver::release() noexcept {
  flush();
  pipeline_.drop_scan();
  connection_.close();
  setup_.clear();
  stage_ = stage::closed;
  lost_ = error(task::reading, problem::gone, "this lidar, which was closed");
}

result<answer> live_driver::ask(const request& wanted, while_scanning how) {
  const bool goes_on = question_.was_woken(wanted) && session_.is_busy();
  if (!goes_on) {
    question_.forget_woken();
    if (auto begun = begin_question(wanted, how); !begun) return tl::unexpected(begun.error());
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
  if (found->how != verdict::answered) return tl::unexpected(error_of(*found));
  if (!setup_.is_done()) {  // after a restart
    const auto ready = run_setup();
    const bool wakes = !ready && ready.error() == problem::cancelled;
    if (!ready && !wakes) return tl::unexpected(ready.error());
    if (wakes) connection_.wake_next_call();  // the next call continues it
  }
  return found->value;
}

result<void> live_driver::begin_question(const request& wanted, while_scanning how) {
  if (auto ready = run_setup(); !ready) return ready;
  if (const auto refused = session_.begin(wanted, now_ns(), how)) {
    const bool is_bad = *refused == refusal::bad_setting;
    return failure(task::asking, is_bad ? problem::bad_setting : problem::scanning,
                   error_context(connection_.name()).add(wanted));
  }
  return {};
}

void live_driver::add_to(lidar_counts& counts) const noexcept {
  counts.command_retries = session_.retries();
  counts.reconnects = reconnection_.count();
}

}  // namespace g4lidar
