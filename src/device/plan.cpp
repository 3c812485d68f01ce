// SPDX-License-Identifier: MIT
// The driver's plan: what is asked in which order, and what the answers mean.
#include <utility>

#include "driver.hpp"
#include "rival.hpp"
#include "subject.hpp"

namespace g4lidar {
namespace {

/// Set-ups one soon after the other, of a device that never scans for so long.
constexpr int max_set_ups = 3;
constexpr std::int64_t long_life_ns = 6'000'000'000;

}  // namespace

void lidar::driver::plan(request wanted, bool needed) {
  if (plan_at_ == planned_) planned_ = plan_at_ = 0;  // all of it has been done
  woken_question_.reset();
  if (planned_ < plan_.size()) plan_[planned_++] = {wanted, needed};
}

void lidar::driver::plan_start() {
  stage_ = stage::preparing;
  stops_ = false;
  plan(requests::health(), false);
  if (options_.ranging) {
    plan(requests::set(*options_.ranging), true);
  } else {
    plan(requests::get_ranging(), false);
  }
  if (options_.frequency) plan(requests::set(*options_.frequency), true);
  if (options_.direction) plan(requests::set(*options_.direction), true);
  if (options_.constant) plan(requests::set(*options_.constant), true);
  if (options_.idle) plan(requests::set(*options_.idle), true);
  if (options_.protection) plan(requests::set(*options_.protection), true);
  plan(requests::start(), true);
}

/// The device ended a scan by itself. If it began anew, it has forgotten what was set. False if it does
/// so again and again.
bool lidar::driver::set_up_again() {
  const bool is_soon = set_ups_ > 0 && now_ns() - set_up_ns_ < long_life_ns;
  if (is_soon && set_ups_ == max_set_ups) return false;
  set_ups_ = is_soon ? set_ups_ + 1 : 1;
  set_up_ns_ = now_ns();
  planned_ = plan_at_ = 0;
  setting_up_again_ = true;
  plan(requests::stop(), true);
  plan_start();
  return true;
}

/// Waits until all that is planned is done, or fails. It ends, since every request does. Whoever asks
/// again and again while the device is away finds it when it is back.
result<void> lidar::driver::run_plan() {
  if (stage_ == stage::lost) {
    if (auto tried = step(now_ns()); !tried) return tried;
  }
  if (stage_ == stage::closed || stage_ == stage::lost) return tl::unexpected(lost_);
  while (plan_at_ < planned_ || session_.is_busy()) {
    // A scan may be complete before the start is done: that one is for next_scan().
    if (!(stage_ == stage::preparing && session_.is_scanning())) drop_scan();
    if (auto done = step(never_ns); !done) return done;
    if (stage_ == stage::lost) return tl::unexpected(lost_);
  }
  return {};
}

/// Takes the outcome of what was asked last, and asks the next.
result<void> lidar::driver::go_on_with_plan() {
  while (true) {
    if (const auto done = session_.finished()) {
      has_outcome_ = true;
      learn_rate(*done);
      if (plan_at_ < planned_ && !asking_) {
        if (auto good = finish_errand(*done); !good) return good;
      } else {
        remember(*done);  // whoever has asked, and whether or not it still waits
      }
      if (asking_) asked_ = done;
    }
    if (asking_ || plan_at_ == planned_ || session_.is_busy()) return {};
    const request& next = plan_[plan_at_].wanted;
    if (next.what == ask::start) {
      begin_points();
      has_streamed_ = has_streamed_ && setting_up_again_;
    }
    if (session_.begin(next, now_ns())) return {};  // busy with what it found by itself
    if (session_.is_busy()) return {};
  }
}

void lidar::driver::learn_rate(const outcome& done) {
  const auto* ranging = std::get_if<ranging_frequency>(&done.value);
  if (ranging == nullptr || samples_per_second(*ranging) == samples_per_second_) return;
  samples_per_second_ = samples_per_second(*ranging);
  if (delivers_) begin_points();
}

/// What was set by asking is set again like what the options say, and behind a restart at once.
void lidar::driver::remember(const outcome& done) {
  if (done.asked.what == ask::restart && wants_scan_) {
    set_ups_ = 0;  // however often somebody wishes it
    set_up_again();
  }
  if (done.how != verdict::answered) return;
  const auto keep = [&]<class Setting>(std::optional<Setting>& option) {
    if (const auto* value = std::get_if<Setting>(&done.value)) option = *value;
  };
  switch (done.asked.what) {
    case ask::set_low_power:
      return keep(options_.idle);
    case ask::set_direction:
      return keep(options_.direction);
    case ask::step_scan_frequency:
    case ask::set_scan_frequency:
      return keep(options_.frequency);
    case ask::set_constant_frequency:
      return keep(options_.constant);
    case ask::set_ranging:
      return keep(options_.ranging);
    case ask::set_protection:
      return keep(options_.protection);
    default:
      return;
  }
}

result<void> lidar::driver::finish_errand(const outcome& done) {
  const errand current = plan_[plan_at_++];
  if (done.how != verdict::answered) {
    // Who does not even answer what every G4 knows is not there any more.
    if (!current.needed && !done.heard_nothing()) return {};
    return give_up(error_of(done));
  }
  if (const auto* said = std::get_if<health>(&done.value)) {
    if (said->status == health_status::error) {
      const subject code =
          subject(name()).add(", error code ").add(std::uint32_t{said->error_code});
      return give_up(error(task::starting, problem::unhealthy, code));
    }
    if (said->status == health_status::warning) tell(lidar_event::kind::health_warning);
  }
  if (const auto* who = std::get_if<device_information>(&done.value)) return identified(*who);
  if (current.wanted.what == ask::start) started();
  return {};
}

/// A device that answers, but not as it should, need not be given up: what was asked of it is.
result<void> lidar::driver::give_up(const error& why) {
  planned_ = plan_at_ = 0;
  const bool is_silent = why.what() == problem::silence || why.what() == problem::timeout;
  if (setting_up_again_ && is_silent) return tl::unexpected(fallen_silent());
  const bool of_use = stage_ == stage::preparing && why.what() != problem::silence;
  const bool goes_on = wants_scan_ && (reconnecting_ || setting_up_again_);
  if (!of_use || goes_on) return tl::unexpected(why);
  stage_ = stage::idle;
  wants_scan_ = false;
  refused_ = why;
  return {};
}

result<void> lidar::driver::identified(const device_information& who) {
  if (who.model != model_g4) {
    const subject model = subject(name()).add(", model ").add(std::uint32_t{who.model});
    return failure(task::opening, problem::other_device, model);
  }
  if (opened_ && who.serial_digits != information_.serial_digits) {
    // Another lidar: ours may be behind another port.
    backoff_ns_ = 0;
    return failure(task::finding, problem::no_port, name());
  }
  reconnecting_ = opened_;
  information_ = who;
  opened_ = true;
  stage_ = stage::idle;
  if (wants_scan_) {
    plan_start();
  } else if (reconnecting_) {
    back_again();
  }
  return {};
}

void lidar::driver::started() {
  stage_ = stage::scanning;
  setting_up_again_ = false;
  if (reconnecting_) back_again();
}

void lidar::driver::back_again() {
  reconnecting_ = false;
  backoff_ns_ = 0;
  ++reconnects_;
  tell(lidar_event::kind::reconnected);
}

/// Of a device that has ended a scan, and does not come back.
error lidar::driver::fallen_silent() const {
  if (has_streamed_) return {task::reading, problem::stalled, name()};
  return {task::starting, problem::brown_out, name()};
}

error lidar::driver::error_of(const outcome& done) const {
  const auto doing = [&] {
    switch (done.asked.what) {
      case ask::start:
        return task::starting;
      case ask::stop:
        return task::stopping;
      default:
        break;
    }
    if (stage_ == stage::identifying) return task::opening;
    if (stage_ != stage::preparing) return task::asking;
    return done.asked.what == ask::health ? task::starting : task::configuring;
  }();
  subject about(name());
  if (stage_ != stage::identifying) about.add(done.asked);
  if (done.how == verdict::not_reached) {
    if (const auto* reached = std::get_if<scan_frequency>(&done.value)) {
      about.add(" (reached ").add(*reached).add(")");
    }
    return {doing, problem::not_reached, about};
  }
  if (done.how == verdict::still_scanning) return spoilt({doing, problem::does_not_stop, about});
  if (done.heard_nothing() && stage_ <= stage::preparing && stage_ != stage::idle) {
    return spoilt({doing, problem::silence, about});
  }
  if (done.heard_noise_only()) return spoilt({doing, problem::garbage, about});
  return spoilt({doing, done.wrong_answers > 0 ? problem::wrong_answer : problem::timeout, about});
}

/// Another program on the port explains more than what it has led to.
error lidar::driver::spoilt(const error& why) const {
  return line_ != nullptr ? with_rivals(why, *line_) : why;
}

}  // namespace g4lidar
