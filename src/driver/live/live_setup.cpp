// SPDX-License-Identifier: MIT
// The setup of a live device: when each step is sent, and the effects of the answers.
#include "driver/error_context.hpp"
#include "driver/outcome_error.hpp"
#include "live_driver.hpp"

namespace g4lidar {
namespace {

/// A setting of ask() is set again like an option, after a restart immediately.
void remember(const outcome& done, lidar_options& options) {
  if (done.how != verdict::answered) return;
  const auto keep = [&]<class Setting>(std::optional<Setting>& option) {
    if (const auto* value = std::get_if<Setting>(&done.value)) option = *value;
  };
  switch (done.asked.what) {
    case request_kind::set_low_power:
      return keep(options.idle);
    case request_kind::set_direction:
      return keep(options.direction);
    case request_kind::step_scan_frequency:
    case request_kind::set_scan_frequency:
      return keep(options.frequency);
    case request_kind::set_constant_frequency:
      return keep(options.constant);
    case request_kind::set_sample_rate:
      return keep(options.sample_rate);
    case request_kind::set_protection:
      return keep(options.protection);
    default:
      return;
  }
}

}  // namespace

/// The device ended a scan by itself. If it rebooted, it has lost its settings. Returns false if
/// this happens repeatedly.
bool live_driver::set_up_again() {
  if (!setup_.begin_again(options_, stream_.talk().scan_length_ns())) return false;
  question_.forget_woken();
  stage_ = live_stage::preparing;
  return true;
}

/// Takes the outcome of the last command, and begins the next. Returns whether there was one.
result<bool> live_driver::go_on_with_setup() {
  session& talk = stream_.talk();
  bool has_outcome = false;
  while (true) {
    if (const auto done = talk.finished()) {
      has_outcome = true;
      if (auto good = take_outcome(*done); !good) return tl::unexpected(good.error());
    }
    if (question_.is_open() || setup_.is_done() || talk.is_busy()) return has_outcome;
    if (setup_.starts_next()) {
      if (stream_.motor_ready_ns() > now_ns()) return has_outcome;
      if (auto raised = stream_.set_motor(true); !raised) return tl::unexpected(raised.error());
      stream_.begin_points();
      if (!setup_.is_again()) {
        scans_at_begin_ = pipeline_.counts().scans;
        skipped_at_begin_ = pipeline_.counts().stream.skipped_bytes();
      }
    }
    if (listens()) return has_outcome;
    if (setup_.next() == setup_step::identify) {
      // The motor starts at an edge, and the system raises the line when it opens a port.
      if (auto lowered = stream_.set_motor(false); !lowered) return tl::unexpected(lowered.error());
    }
    const request next = request_of(setup_.next(), options_);
    stream_.heard() = {};
    const auto refused = talk.begin(next, now_ns());
    if (refused == refusal::bad_setting || refused == refusal::not_supported) {
      const error why =
          refusal_error(task::configuring, *refused, next, *options_.model, connection_.name());
      if (auto given = give_up(why); !given) return tl::unexpected(given.error());
      return has_outcome;
    }
    // If it is refused, the session is busy with its own recovery.
    if (refused || talk.is_busy()) return has_outcome;
  }
}

result<void> live_driver::take_outcome(const outcome& done) {
  stream_.learn(done.value);
  if (!setup_.is_done() && !question_.is_open()) {
    if (auto good = finish_step(done); !good) return good;
  } else {
    remember(done, options_);  // for every request, also if its caller no longer waits
    // The device was restarted by the caller, or perhaps by itself: its scan was not resumed at once.
    const bool is_restart = done.asked.what == request_kind::restart;
    if (wants_scan_ && (is_restart || done.starts > 1)) {
      if (is_restart) setup_.reset_short_scans();  // requests of the caller are not limited
      static_cast<void>(set_up_again());
      if (is_restart)
        setup_.reset_short_scans();  // and a scan that never begins afterwards is started once more
    }
  }
  question_.answer(done);
  return {};
}

result<void> live_driver::finish_step(const outcome& done) {
  const setup_step finished = setup_.next();
  setup_.finish_next();
  if (finished == setup_step::stop) {
    if (auto lowered = stream_.set_motor(false); !lowered) return lowered;
  }
  if (done.how != verdict::answered) {
    // A device that does not answer a command that every two-way lidar knows is lost.
    if (!is_needed(finished, options_) && !done.heard_nothing()) return {};
    return give_up(
        stream_.error_after(error_of(done, stage_, connection_, *options_.model, stream_.heard())));
  }
  if (const auto* reply = std::get_if<health>(&done.value)) {
    if (reply->status == health_status::error) {
      const error_context code = error_context(connection_.name())
                                     .add(", error code ")
                                     .add(std::uint32_t{reply->error_code});
      return give_up(error(task::starting, problem::unhealthy, code));
    }
    if (reply->status == health_status::warning) report(lidar_event::kind::health_warning);
  }
  if (const auto* who = std::get_if<device_information>(&done.value)) return answered(*who);
  const bool is_start = finished == setup_step::start;
  if (is_doubtful(finished, done) && setup_.repeat_start(options_, is_start)) return {};
  if (!is_start) return {};
  stage_ = live_stage::scanning;
  setup_.clear();
  if (reconnection_.end()) report(lidar_event::kind::reconnected);
  return {};
}

/// A device that answers, but cannot be set up, is not lost: only the request fails.
result<void> live_driver::give_up(const error& why) {
  const bool is_again = setup_.is_again();
  const bool is_silent = why == problem::silence || why == problem::timeout;
  setup_.clear();
  if (is_again && is_silent) return tl::unexpected(silence_error());
  const bool of_use = stage_ == live_stage::preparing && why != problem::silence;
  const bool goes_on = wants_scan_ && (reconnection_.is_under_way() || is_again);
  if (!of_use || goes_on) return tl::unexpected(why);
  stage_ = live_stage::idle;
  wants_scan_ = false;
  refused_ = why;
  return {};
}

result<void> live_driver::answered(const device_information& who) {
  if (auto known = identified(who); !known) return known;
  const model& like = with_firmware(*options_.model, who);
  if (&like != options_.model) stream_.talk().reset(&like);
  become_recognised();
  stage_ = live_stage::idle;
  if (wants_scan_) {
    stage_ = live_stage::preparing;
    question_.forget_woken();
    setup_.add_start(options_);
  } else if (reconnection_.end()) {
    report(lidar_event::kind::reconnected);
  }
  return {};
}

}  // namespace g4lidar
