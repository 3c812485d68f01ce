// SPDX-License-Identifier: MIT
// The steps with commands that change something: protection, frequency, sample rate, start and stop.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>

#include "kit_rows.hpp"

namespace g4_tool::acceptance {
namespace {

using enum command;

/// Steps until the answer does not change any more: by hertz, and then by tenths where a step beyond the limit is
/// refused. The last answer.
std::optional<std::int32_t> go_to_limit(lidar_link& link, command coarse, command fine) {
  constexpr int most_steps = 24;
  std::optional<std::int32_t> last;
  for (const command each : {coarse, fine}) {
    for (int i = 0; i < most_steps; ++i) {
      static_cast<void>(link.ask(each));
      const auto now = link.number(frequency_query);
      if (!now || now == last) break;
      last = now;
    }
  }
  return last;
}

}  // namespace

// Sent twice if it is not answered: where only the answers are missing, it is as before.
void protection(tested_lidar& lidar, step_result& result) {
  lidar.settings.begin_change(setting::protection);
  const raw_reply first = lidar.link->ask(protection_toggle);
  if (const auto state = first.number()) lidar.settings.learn_from(setting::protection, *state, 2);
  const raw_reply last = first.is_response() ? first : lidar.link->ask(protection_toggle);
  if (!last.is_response()) lidar.settings.has_none(setting::protection);
  result.add("answers_d9", last.is_response());
  result.add("reply", last.text());
}

void frequency(tested_lidar& lidar, step_result& result) {
  const auto before = lidar.settings.before(setting::frequency);
  if (!before)
    return result.find(finding::differs, "The setting is not answered, and was not changed.");
  lidar.settings.begin_change(setting::frequency);
  const auto highest = go_to_limit(*lidar.link, frequency_up_1_hz, frequency_up_0_1_hz);
  const auto lowest = go_to_limit(*lidar.link, frequency_down_1_hz, frequency_down_0_1_hz);
  const auto in_hz = [&lidar](std::optional<std::int32_t> chz) {
    return (chz.value_or(0) + lidar.row.frequency.reply_offset_chz) / 100.0;
  };
  result.add("before_hz", in_hz(before));
  result.add("highest_hz", in_hz(highest));
  result.add("lowest_hz", in_hz(lowest));
}

void sample_rate(tested_lidar& lidar, step_result& result) {
  constexpr std::int64_t measured_ns = 3'000 * ms;
  constexpr std::size_t most_codes = 6;
  std::set<std::int32_t> codes;
  std::size_t most_samples = 0;
  bool is_answered = false;
  while (codes.size() < most_codes) {
    lidar.settings.begin_change(setting::sample_rate);
    auto code = lidar.link->ask(sample_rate_next).number();
    is_answered = is_answered || code;
    // Where only the answer was lost, the query shows the step.
    if (!code) code = lidar.link->number(sample_rate_query);
    if (code && codes.empty())
      lidar.settings.learn_from(setting::sample_rate, *code, rate_count(lidar.row));
    if (!code || !codes.insert(*code).second) break;
    static_cast<void>(lidar.link->start());
    static_cast<void>(lidar.link->survey(measured_ns));  // while the motor spins up
    const packet_survey heard = steady_survey(*lidar.link, measured_ns);
    lidar.link->stop();
    if (heard.is_steady() || heard.counts.packets == 0) {
      result.add(fmt::format("code_{}_hz", *code), heard.sample_rate_hz());
    } else {
      result.find(finding::observed, not_steady);
    }
    result.add(fmt::format("code_{}_samples", *code), heard.most_samples);
    most_samples = std::max(most_samples, heard.most_samples);
  }
  result.add("answers_d0", is_answered);
  if (codes.empty()) return lidar.settings.has_none(setting::sample_rate);
  result.add("codes", codes.size());
  result.add("most_samples", most_samples);
}

void start_and_stop(tested_lidar& lidar, step_result& result) {
  lidar_link& link = *lidar.link;
  link.listen_for(run_down_ns);
  const std::int64_t begin_ns = link.now_ns();
  const std::int64_t first_ns = link.start();
  result.add("starts", first_ns >= 0);
  if (first_ns < 0) {
    link.stop();
    return;
  }
  result.add("first_packet_ms", in_ms(first_ns));
  const steady_motor motor = wait_until_steady(link);
  result.add("turns_steadily", motor.hz > 0.0);
  if (motor.hz > 0.0) {
    result.add("turns_hz", motor.hz);
    result.add("steady_after_ms", in_ms(motor.since_ns - begin_ns));
  }
  link.send(forced_stop);
  const std::int64_t forced_ns = link.wait_for_silence(2'000 * ms);
  result.add("stops_by_00", forced_ns >= 0);
  if (forced_ns >= 0) result.add("silent_after_00_ms", in_ms(forced_ns));
  static_cast<void>(link.start());
  static_cast<void>(link.survey(500 * ms));
  link.send(stop);
  const std::int64_t stopped_ns = link.wait_for_silence(2'000 * ms);
  result.add("stops_by_65", stopped_ns >= 0);
  if (stopped_ns >= 0) result.add("silent_after_65_ms", in_ms(stopped_ns));
  link.stop();
}

}  // namespace g4_tool::acceptance
