// SPDX-License-Identifier: MIT
// The step with the line DTR. Whether an edge or the level starts the motor shows only where the line is
// high without a pulse of the program: after the system has raised it, because the port was opened, and
// after a low that is too short for an edge that is debounced.
#include <fmt/format.h>

#include <string>

#include "rows.hpp"

namespace g4_tool::acceptance {
namespace {

using enum finding;

constexpr std::int64_t silence_ns = 5'000 * ms;
constexpr std::int64_t start_ns = 8'000 * ms;
constexpr std::int64_t boot_ns = 2'000 * ms;

/// Whether it sends after a start, without anything done to the line.
bool starts(lidar_link& link) {
  if (link.is_two_way()) link.send(command::start);
  return link.wait_for_packet(start_ns) >= 0;
}

/// Of a one-way lidar whose line has just become high; returns whether it sends.
bool measure_spin_up(lidar_link& link, step_result& into) {
  const std::int64_t begin_ns = link.now_ns();
  const std::int64_t first_ns = link.wait_for_packet(start_ns);
  if (first_ns < 0) return false;
  into.add("resumes_after_ms", in_ms(first_ns));
  const steady_motor motor = wait_until_steady(link);
  if (motor.hz > 0.0) into.add("steady_after_ms", in_ms(motor.since_ns - begin_ns));
  return true;
}

/// What a low line takes from the lidar. The line is low. `has_answered`: to 90, while it was high. Returns whether it
/// boots when the line rises.
bool find_cut(lidar_link& link, bool has_answered, step_result& into) {
  bool answers = false;
  if (link.is_two_way()) {
    link.stop_scan();  // some answer nothing while they scan
    answers = link.ask(command::device_info, 1'000 * ms).is_response();
    into.add("answers_while_low", answers);
  }
  const std::uint64_t boots = link.boots();
  const std::uint64_t responses = link.counts().responses;
  link.set_dtr(true);
  bool resumes = false;
  if (link.is_two_way()) {
    link.listen_for(boot_ns);
  } else {
    resumes = measure_spin_up(link, into);
  }
  const bool boots_again = link.boots() != boots || link.counts().responses != responses;
  if (link.is_two_way()) resumes = starts(link);
  into.add("boots_again", boots_again);
  into.add("high_resumes", resumes);
  const bool is_silent = link.is_two_way() && !answers && has_answered;
  const bool is_supply = boots_again || is_silent;
  if (is_supply || answers) {
    into.add("dtr_switches", std::string(is_supply ? "supply" : "motor"));
    into.find(observed, fmt::format("DTR switches the {}.", is_supply ? "supply" : "motor"));
  } else {
    into.find(observed,
              "It sent no boot message when DTR rose; some lidars send none at power-on.");
  }
  return boots_again;
}

/// How the line must become high.
void find_start(subject& of, step_result& into) {
  constexpr std::int64_t short_ns = 10 * ms;
  of.link->stop();
  of.link->set_dtr(false);
  of.link->listen_for(run_down_ns);
  if (!of.reopen(5'000 * ms)) return;
  lidar_link& link = *of.link;
  link.listen_for(boot_ns);
  const bool by_opening = starts(link);
  into.add("starts_by_opening", by_opening);
  bool goes_on = false;
  if (by_opening) {
    pulse_dtr(link, short_ns);
    link.listen_for(run_down_ns);
    // Where the supply was cut, it must be started again.
    goes_on = link.wait_for_packet(silence_ns) >= 0 || starts(link);
    into.add("goes_on_after_short_low", goes_on);
  }
  const std::string by = !by_opening ? "an edge while the port is open"
                         : goes_on   ? "the level of DTR"
                                     : "an edge, that of an opened port too";
  into.add("starts_by", by);
  into.find(observed, "It is started by " + by + ".");
}

}  // namespace

void dtr(subject& of, step_result& into) {
  lidar_link& link = *of.link;
  if (!link.set_dtr(true)) return into.find(not_done, "The connection has no DTR.");
  pulse_dtr(link);
  bool turns = starts(link);
  // Where the line switches the supply, it had to boot before.
  if (!turns && of.is_two_way()) turns = starts(link);
  into.add("starts_with_edge", turns);
  if (!turns) {
    link.stop();
    return;
  }
  link.set_dtr(false);
  const std::int64_t silent_ns = link.wait_for_silence(silence_ns);
  into.add("low_silences", silent_ns >= 0);
  if (silent_ns >= 0) {
    into.add("silent_after_ms", in_ms(silent_ns));
    of.boots_after_dtr = find_cut(link, !of.identified.empty(), into);
    find_start(of, into);
  }
  if (!of.link) return;
  of.link->set_dtr(true);
  of.link->stop();
}

}  // namespace g4_tool::acceptance
