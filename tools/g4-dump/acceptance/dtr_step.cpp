// SPDX-License-Identifier: MIT
// The step with the line DTR. Whether an edge or the level starts the motor shows only where the line is
// high without a pulse of the program: after the system has raised it, because the port was opened, and
// after a low that is too short for an edge that is debounced.
#include <fmt/format.h>

#include <string>

#include "kit_rows.hpp"

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
bool measure_spin_up(lidar_link& link, step_result& result) {
  const std::int64_t begin_ns = link.now_ns();
  const std::int64_t first_ns = link.wait_for_packet(start_ns);
  if (first_ns < 0) return false;
  result.add("resumes_after_ms", in_ms(first_ns));
  const steady_motor motor = wait_until_steady(link);
  if (motor.hz > 0.0) result.add("steady_after_ms", in_ms(motor.since_ns - begin_ns));
  return true;
}

/// What a low line takes from the lidar. The line is low. `has_answered`: to 90, while it was high. Returns whether it
/// boots when the line rises.
bool find_cut(lidar_link& link, bool has_answered, step_result& result) {
  bool answers = false;
  if (link.is_two_way()) {
    link.stop_scan();  // some answer nothing while they scan
    answers = link.ask(command::device_info, 1'000 * ms).is_response();
    result.add("answers_while_low", answers);
  }
  const std::uint64_t boots = link.boots();
  const std::uint64_t responses = link.counts().responses;
  link.set_dtr(true);
  bool resumes = false;
  if (link.is_two_way()) {
    link.listen_for(boot_ns);
  } else {
    resumes = measure_spin_up(link, result);
  }
  const bool boots_again = link.boots() != boots || link.counts().responses != responses;
  if (link.is_two_way()) resumes = starts(link);
  result.add("boots_again", boots_again);
  result.add("high_resumes", resumes);
  const bool is_silent = link.is_two_way() && !answers && has_answered;
  const bool is_supply = boots_again || is_silent;
  if (is_supply || answers) {
    result.add("dtr_switches", std::string(is_supply ? "supply" : "motor"));
    result.find(observed, fmt::format("DTR switches the {}.", is_supply ? "supply" : "motor"));
  } else {
    result.find(observed,
                "It sent no boot message when DTR rose; some lidars send none at power-on.");
  }
  return boots_again;
}

/// How the line must become high.
void find_start(tested_lidar& lidar, step_result& result) {
  constexpr std::int64_t short_ns = 10 * ms;
  lidar.link->stop();
  lidar.link->set_dtr(false);
  lidar.link->listen_for(run_down_ns);
  if (!lidar.reopen(5'000 * ms)) return;
  lidar_link& link = *lidar.link;
  link.listen_for(boot_ns);
  const bool by_opening = starts(link);
  result.add("starts_by_opening", by_opening);
  bool goes_on = false;
  if (by_opening) {
    pulse_dtr(link, short_ns);
    link.listen_for(run_down_ns);
    // Where the supply was cut, it must be started again.
    goes_on = link.wait_for_packet(silence_ns) >= 0 || starts(link);
    result.add("goes_on_after_short_low", goes_on);
  }
  const std::string by = !by_opening ? "an edge while the port is open"
                         : goes_on   ? "the level of DTR"
                                     : "an edge, that of an opened port too";
  result.add("starts_by", by);
  result.find(observed, "It is started by " + by + ".");
}

}  // namespace

void dtr(tested_lidar& lidar, step_result& result) {
  lidar_link& link = *lidar.link;
  if (!link.set_dtr(true)) return result.find(not_done, "The connection has no DTR.");
  pulse_dtr(link);
  bool turns = starts(link);
  // Where the line switches the supply, it had to boot before.
  if (!turns && lidar.is_two_way()) turns = starts(link);
  result.add("starts_with_edge", turns);
  if (!turns) {
    link.stop();
    return;
  }
  link.set_dtr(false);
  const std::int64_t silent_ns = link.wait_for_silence(silence_ns);
  result.add("low_silences", silent_ns >= 0);
  if (silent_ns >= 0) {
    result.add("silent_after_ms", in_ms(silent_ns));
    lidar.boots_after_dtr = find_cut(link, !lidar.identified.empty(), result);
    find_start(lidar, result);
  }
  if (!lidar.link) return;
  lidar.link->set_dtr(true);
  lidar.link->stop();
}

}  // namespace g4_tool::acceptance
