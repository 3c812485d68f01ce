// SPDX-License-Identifier: MIT
// The setup of a live device: when each step is sent, and the effects of the answers.
#include <utility>

#include "error_context.hpp"
#include "live_driver.hpp"

namespace g4lidar {
void live_driver::add_step(setup_step step) {
  question_.forget_woken();
  setup_.add(step);
}

void live_driver::add_start() {
  stage_ = stage::preparing;
  question_.forget_woken();
  setup_.add_start(options_);
}

/// The device ended a scan by itself. If it rebooted, it has lost its settings. Returns false if
/// this happens repeatedly.
bool live_driver::set_up_again() {
  if (!setup_.begin_again(options_, session_.scan_length_ns())) return false;
  question_.forget_woken();
  stage_ = stage::preparing;
  return true;
}

/// Waits until all steps are done, or one fails. It ends, because every request ends. If the caller
/// calls repeatedly while the device is away, a later call completes after the reconnect.
result<void> live_driver::run_setup() {
  if (stage_ == stage::lost) {
    if (auto tried = step(now_ns()); !tried) return tried;
  }
  if (stage_ == stage::closed || stage_ == stage::lost) return tl::unexpected(unavailable());
  while (stage_ >= stage::breaking || !setup_.is_done() || session_.is_busy()) {
    // A scan may be complete before the start is done: next_scan() returns it.
    if (!(stage_ == stage::preparing && session_.is_scanning())) pipeline_.drop_scan();
    if (auto done = step(never_ns); !done) return done;
    if (stage_ == stage::lost) return tl::unexpected(unavailable());
  }
  return {};
}

/// Takes the outcome of the last command, and begins the next. Returns whether there was one.
result<bool> live_driver::go_on_with_setup() {
  bool has_outcome = false;
  while (true) {
    if (const auto done = session_.finished()) {
      has_outcome = true;
      learn_rate(*done);
      if (!setup_.is_done() && !question_.is_open()) {
        if (auto good = finish_step(*done); !good) return tl::unexpected(good.error());
      } else {
        remember(*done);  // for every request, also if its caller no longer waits
        restore_settings(*done);
      }
      question_.answer(*done);
    }
    if (question_.is_open() || setup_.is_done() || session_.is_busy()) return has_outcome;
    if (setup_.next() == setup_step::start) {
      begin_points();
      if (!setup_.is_again()) pipeline_.begin_scans();
    }
    const request next = request_of(setup_.next(), options_);
    const auto refused = session_.begin(next, now_ns());
    if (refused == refusal::bad_setting) {
      const error_context about = error_context(connection_.name()).add(next);
      if (auto given = give_up({task::configuring, problem::bad_setting, about}); !given) {
        return tl::unexpected(given.error());
      }
      return has_outcome;
    }
    if (refused) return has_outcome;  // the session is busy with its own recovery
    if (session_.is_busy()) return has_outcome;
  }
}

void live_driver::learn_rate(const outcome& done) {
  const auto* rate = std::get_if<sample_rate>(&done.value);
  if (rate == nullptr || to_hz(*rate) == sample_rate_hz_) return;
  sample_rate_hz_ = to_hz(*rate);
  if (pipeline_.delivers()) begin_points();
}

/// A setting of ask() is set again like an option, after a restart immediately.
void live_driver::remember(const outcome& done) {
  if (done.how != verdict::answered) return;
  const auto keep = [&]<class Setting>(std::optional<Setting>& option) {
    if (const auto* value = std::get_if<Setting>(&done.value)) option = *value;
  };
  switch (done.asked.what) {
    case request_kind::set_low_power:
      return keep(options_.idle);
    case request_kind::set_direction:
      return keep(options_.direction);
    case request_kind::step_scan_frequency:
    case request_kind::set_scan_frequency:
      return keep(options_.frequency);
    case request_kind::set_constant_frequency:
      return keep(options_.constant);
    case request_kind::set_sample_rate:
      return keep(options_.sample_rate);
    case request_kind::set_protection:
      return keep(options_.protection);
    default:
      return;
  }
}

/// The device was restarted by the caller, or perhaps by itself: its scan was not resumed at once.
void live_driver::restore_settings(const outcome& done) {
  const bool is_wanted = done.asked.what == request_kind::restart;
  if (!wants_scan_ || (!is_wanted && done.starts <= 1)) return;
  if (is_wanted) setup_.reset_short_scans();  // requests of the caller are not limited
  static_cast<void>(set_up_again());
  if (is_wanted)
    setup_.reset_short_scans();  // and a scan that never begins afterwards is started once more
}

result<void> live_driver::finish_step(const outcome& done) {
  const setup_step finished = setup_.next();
  setup_.finish_next();
  if (done.how != verdict::answered) {
    // A device that does not answer a command that every G4 knows is lost.
    if (!is_needed(finished, options_) && !done.heard_nothing()) return {};
    return give_up(error_of(done));
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
  if (const auto* who = std::get_if<device_information>(&done.value)) return identified(*who);
  const bool is_start = finished == setup_step::start;
  if (is_doubtful(finished, done) && setup_.repeat_start(options_, is_start)) return {};
  if (is_start) started();
  return {};
}

/// A device that answers, but cannot be set up, is not lost: only the request fails.
result<void> live_driver::give_up(const error& why) {
  const bool is_again = setup_.is_again();
  const bool is_silent = why == problem::silence || why == problem::timeout;
  setup_.clear();
  if (is_again && is_silent) return tl::unexpected(silence_error());
  const bool of_use = stage_ == stage::preparing && why != problem::silence;
  const bool goes_on = wants_scan_ && (reconnection_.is_under_way() || is_again);
  if (!of_use || goes_on) return tl::unexpected(why);
  stage_ = stage::idle;
  wants_scan_ = false;
  refused_ = why;
  return {};
}

result<void> live_driver::identified(const device_information& who) {
  if (who.model != model_g4) {
    const error_context model =
        error_context(connection_.name()).add(", model ").add(std::uint32_t{who.model});
    return failure(task::opening, problem::other_device, model);
  }
  if (is_known() && who.serial_digits != information_.serial_digits) {
    connection_.from().refuse();  // the wanted lidar may be behind another port
    if (reconnection_.refuse(who)) report(lidar_event::kind::other_lidar);
    return failure(task::finding, problem::no_port, connection_.name());
  }
  if (is_known()) reconnection_.found();
  information_ = who;
  stage_ = stage::idle;
  if (wants_scan_) {
    add_start();
  } else if (reconnection_.is_under_way()) {
    back_again();
  }
  return {};
}

void live_driver::started() {
  stage_ = stage::scanning;
  setup_.clear();
  if (reconnection_.is_under_way()) back_again();
}

void live_driver::back_again() {
  reconnection_.end();
  report(lidar_event::kind::reconnected);
}

/// A device that has ended a scan and does not continue.
error live_driver::silence_error() const {
  if (pipeline_.has_begun()) return {task::reading, problem::stalled, connection_.name()};
  return {task::starting, problem::brown_out, connection_.name()};
}

task live_driver::task_of(const request& asked) const noexcept {
  if (asked.what == request_kind::start) return task::starting;
  if (asked.what == request_kind::stop) return task::stopping;
  if (stage_ == stage::identifying) return task::opening;
  if (stage_ != stage::preparing) return task::asking;
  return asked.what == request_kind::health ? task::starting : task::configuring;
}

error live_driver::error_of(const outcome& done) const {
  const task doing = task_of(done.asked);
  error_context about(connection_.name());
  if (stage_ != stage::identifying) about.add(done.asked);
  if (done.how == verdict::not_reached) {
    if (const auto* reached = std::get_if<scan_frequency>(&done.value)) {
      about.add(" (reached ").add(*reached).add(")");
    }
    return {doing, problem::not_reached, about};
  }
  if (done.how == verdict::still_scanning)
    return error_after({doing, problem::does_not_stop, about});
  const bool is_setting_up = stage_ == stage::identifying || stage_ == stage::preparing;
  if (done.heard_nothing() && is_setting_up) return error_after({doing, problem::silence, about});
  if (done.heard_noise_only()) return error_after({doing, problem::garbage, about});
  return error_after(
      {doing, done.wrong_answers > 0 ? problem::wrong_answer : problem::timeout, about});
}

}  // namespace g4lidar
