// SPDX-License-Identifier: MIT
// The step with the line DTR. Whether an edge or the level starts the motor shows only where the line is
// high without a pulse of the program: after the system has raised it, because the port was opened, and
// after a low that is too short for an edge that is debounced.
#include <string>

#include "acceptance_run.hpp"

namespace g4lidar {
namespace {

using enum acceptance_verdict;
using enum answer_state;
using q = acceptance_question;

constexpr std::int64_t silence_ns = 5'000 * ms;
constexpr std::int64_t start_ns = 8'000 * ms;
constexpr std::int64_t run_down_ns = 3'000 * ms;
constexpr std::int64_t boot_ns = 2'000 * ms;

std::string yes_or_no(bool is_so) { return is_so ? "yes" : "no"; }

/// Whether it sends after a start, without anything done to the line.
bool starts(acceptance_link& link) {
  if (link.is_two_way()) link.send(command::start);
  return link.wait_for_packet(start_ns) >= 0;
}

/// Of a one-way lidar whose line has just become high; returns whether it sends.
bool measure_spin_up(acceptance_link& link, acceptance_result& into) {
  const std::int64_t begin_ns = link.monitor().now_ns();
  const std::int64_t first_ns = link.wait_for_packet(start_ns);
  if (first_ns < 0) return false;
  into.add("resumes_after_ms", in_ms(first_ns));
  if (link.wait_until_steady() > 0.0) {
    const double steady_ms = in_ms(link.monitor().now_ns() - begin_ns);
    into.add("steady_after_ms", steady_ms);
    into.add_answer(q::spin_up, answered, spin_up_words(first_ns, steady_ms));
  }
  return true;
}

/// What a low line takes from the lidar. The line is low. `has_answered`: to 90, while it was high. Returns whether it
/// boots when the line rises.
bool find_cut(acceptance_link& link, bool has_answered, acceptance_result& into) {
  bool answers = false;
  if (link.is_two_way()) {
    static_cast<void>(link.monitor().stop());  // some answer nothing while they scan
    answers = link.ask(static_cast<std::uint8_t>(command::device_info), 1'000 * ms).is_response();
    into.add("answers_while_low", yes_or_no(answers));
  }
  const std::uint64_t boots = link.monitor().boots();
  const std::uint64_t responses = link.monitor().counts().responses;
  static_cast<void>(link.set_dtr(true));
  bool resumes = false;
  if (link.is_two_way()) {
    link.monitor().listen_for(boot_ns);
  } else {
    resumes = measure_spin_up(link, into);
  }
  const bool boots_again =
      link.monitor().boots() != boots || link.monitor().counts().responses != responses;
  if (link.is_two_way()) resumes = starts(link);
  into.add("boots_again", yes_or_no(boots_again));
  into.add("high_resumes", yes_or_no(resumes));
  const bool is_silent = link.is_two_way() && !answers && has_answered;
  const bool is_supply = boots_again || is_silent;
  if (is_supply) {
    into.add_answer(q::dtr_cut, answered, "The supply.");
    into.add_finding(observed, "DTR switches the supply of the lidar.");
  } else if (answers) {
    into.add_answer(q::dtr_cut, answered, "The motor: it answers while DTR is low.");
    into.add_finding(observed, "DTR switches the motor, and not the supply.");
  } else {
    into.add_answer(q::dtr_cut, not_decided,
                    "It sent no boot message when DTR rose; some lidars send none at power-on.");
    into.add_finding(observed, "It sent no boot message when DTR rose.");
  }
  return boots_again;
}

}  // namespace

void acceptance_run::dtr(acceptance_result& into) {
  if (!link_->set_dtr(true)) return into.add_finding(not_done, "The connection has no DTR.");
  pulse_dtr(link_->monitor());
  bool turns = starts(*link_);
  // Where the line switches the supply, it had to boot before.
  if (!turns && is_two_way()) turns = starts(*link_);
  into.add("starts_with_edge", yes_or_no(turns));
  if (!turns) {
    link_->stop();
    return into.add_finding(differs, "No packet came after an edge of DTR.");
  }
  static_cast<void>(link_->set_dtr(false));
  const std::int64_t silent_ns = link_->wait_for_silence(silence_ns);
  dtr_drives_ = silent_ns >= 0;
  into.add("low_silences", yes_or_no(dtr_drives_));
  const bool as_table = dtr_drives_ == (which_->motor == motor_kind::dtr);
  into.add_finding(as_table ? agrees : differs,
                   dtr_drives_ ? "DTR stops it." : "DTR does not stop it.");
  if (dtr_drives_) {
    into.add("silent_after_ms", in_ms(silent_ns));
    boots_after_dtr_ = find_cut(*link_, !identified_.empty(), into);
    dtr_start(into);
  } else {
    for (const q each : {q::dtr_start, q::dtr_cut}) {
      into.add_answer(each, not_applicable, "DTR does not stop it.");
    }
  }
  if (!link_) return;
  static_cast<void>(link_->set_dtr(true));
  link_->stop();
}

/// How the line must become high.
void acceptance_run::dtr_start(acceptance_result& into) {
  constexpr std::int64_t short_ns = 10 * ms;
  link_->stop();
  static_cast<void>(link_->set_dtr(false));
  link_->monitor().listen_for(run_down_ns);
  if (!reopen(5'000 * ms)) {
    return into.add_answer(q::dtr_start, not_decided, "The port could not be opened again.");
  }
  link_->monitor().listen_for(boot_ns);
  const bool by_opening = starts(*link_);
  into.add("starts_by_opening", yes_or_no(by_opening));
  if (!by_opening) {
    into.add_answer(q::dtr_start, answered,
                    "An edge, while the port is open: a line that is high since it was opened "
                    "does not start it.");
    return into.add_finding(observed, "It needs an edge of DTR while the port is open.");
  }
  pulse_dtr(link_->monitor(), short_ns);
  link_->monitor().listen_for(run_down_ns);
  // Where the supply was cut, it must be started again.
  const bool goes_on = link_->wait_for_packet(silence_ns) >= 0 || starts(*link_);
  into.add("goes_on_after_short_low", yes_or_no(goes_on));
  into.add_answer(q::dtr_start, answered,
                  goes_on ? "The level: it turns whenever the line is high."
                          : "An edge; that of an opened port is enough. After 10 ms of low a high "
                            "line does not start it.");
  into.add_finding(observed, goes_on ? "The level of DTR starts it." : "It needs an edge of DTR.");
}

}  // namespace g4lidar
