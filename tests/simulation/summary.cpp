// SPDX-License-Identifier: MIT
#include "summary.hpp"

#include <algorithm>
#include <cmath>

#include "text.hpp"

namespace g4lidar::simulation {

void summary::add(const run_parameters& parameters, const run_report& report) {
  ++runs_;
  failed_ += !report.failure.empty();
  healthy_ += parameters.healthy;
  truth_counts& truths = sum_.truths;
  truths.points += report.truths.points;
  truths.packets += report.truths.packets;
  truths.damaged += report.truths.damaged;
  truths.passed_over += report.truths.passed_over;
  truths.blind_packets += report.truths.blind_packets;
  truths.blind_points += report.truths.blind_points;
  sum_.times.settled += report.times.settled;
  sum_.times.ahead += report.times.ahead;
  sum_.times.late += report.times.late;
  sum_.times.sum_of_squares += report.times.sum_of_squares;
  sum_.times.worst_ns = std::max(sum_.times.worst_ns, report.times.worst_ns);
  sum_.holes += report.holes;
  sum_.reconnects += report.reconnects;
  sum_.opens += report.opens;
  sum_.scans += report.scans;
  sum_.simulated_ns += report.simulated_ns;
  for (std::size_t i = 0; i < report.events.size(); ++i) sum_.events[i] += report.events[i];
  sum_.longest_start_ns = std::max(sum_.longest_start_ns, report.longest_start_ns);
  sum_.longest_ask_ns = std::max(sum_.longest_ask_ns, report.longest_ask_ns);
  sum_.longest_stop_ns = std::max(sum_.longest_stop_ns, report.longest_stop_ns);
  recoveries_s_ += static_cast<double>(report.recovery_ns) * 1e-9;
  longest_recovery_ = std::max(longest_recovery_, static_cast<double>(report.recovery_ns) /
                                                      static_cast<double>(report.allowed_ns));
}

std::string summary::problem() const {
  const time_counts& times = sum_.times;
  if (times.late * 1000 > times.settled) return "too many times are more than 1 ms off";
  const truth_counts& truths = sum_.truths;
  // The checksum misses a second flip in the column of the first, one of 16; of what is damaged most
  // is damaged more or otherwise.
  if (truths.blind_packets * 20 > truths.damaged + 20) return "too many blind spots";
  return {};
}

std::string summary::text() const {
  std::string text;
  const auto number = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
  const double runs = static_cast<double>(std::max<std::uint64_t>(runs_, 1));
  text +=
      text_of("%llu runs, %llu of them healthy, %llu failed; %.0f virtual s, %llu revolutions\n",
              number(runs_), number(healthy_), number(failed_), in_seconds(sum_.simulated_ns),
              number(sum_.scans));
  text += text_of(
      "points %llu; packets %llu, damaged %llu, passed over undamaged %llu; blind spots %llu (%llu "
      "points)\n",
      number(sum_.truths.points), number(sum_.truths.packets), number(sum_.truths.damaged),
      number(sum_.truths.passed_over), number(sum_.truths.blind_packets),
      number(sum_.truths.blind_points));
  text += text_of(
      "opened %llu times, reconnected %llu times; seemingly whole revolutions with a hole %llu\n",
      number(sum_.opens), number(sum_.reconnects), number(sum_.holes));
  for (std::size_t i = 0; i < sum_.events.size(); ++i) {
    text += text_of("%s%s %llu", i == 0 ? "events: " : ", ",
                    name_of(static_cast<lidar_event::kind>(i)).data(), number(sum_.events[i]));
  }
  text += text_of("\nrecovered after %.3f s on average, %.2f of what is allowed at most\n",
                  recoveries_s_ / runs, longest_recovery_);
  const double settled = static_cast<double>(std::max<std::uint64_t>(sum_.times.settled, 1));
  text += text_of("times of %llu settled points: %.1f us RMS, %llu beyond 1 ms, worst %.3f ms\n",
                  number(sum_.times.settled), std::sqrt(sum_.times.sum_of_squares / settled) * 1e-3,
                  number(sum_.times.late), in_seconds(sum_.times.worst_ns) * 1e3);
  text += text_of("points with times in the future %llu\n", number(sum_.times.ahead));
  text += text_of("longest start %.3f s, ask %.3f s, stop or close %.3f s\n",
                  in_seconds(sum_.longest_start_ns), in_seconds(sum_.longest_ask_ns),
                  in_seconds(sum_.longest_stop_ns));
  return text;
}

}  // namespace g4lidar::simulation
