// SPDX-License-Identifier: MIT
// The steps with commands that change something: protection, frequency, sample rate, start and stop.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "acceptance_run.hpp"

namespace g4lidar {
namespace {

using enum acceptance_verdict;
using enum answer_state;
using q = acceptance_question;

}  // namespace

void acceptance_run::protection(acceptance_result& into) {
  constexpr std::uint8_t toggle = 0xD9;
  const raw_reply first = link_->ask(toggle);
  into.add("first_reply", first.text());
  if (!first.number()) {
    if (!identified_.empty()) into.add_answer(q::protection, answered, "D9 is not answered.");
    return into.add_finding(which_->protection == presence::yes ? differs : observed,
                            "D9 is not answered.");
  }
  // 1 means off: another one only if the first switched it on.
  raw_reply last = first;
  if (first.number() == 0) last = link_->ask(toggle);
  into.add("last_reply", last.text());
  const bool is_off = last.number() == 1;
  into.add_answer(q::protection, answered, "D9 is answered.");
  const acceptance_verdict found = which_->protection == presence::yes ? agrees : observed;
  into.add_finding(is_off ? found : differs, is_off ? "D9 is answered; the protection is off."
                                                    : "The protection is not off again.");
}

void acceptance_run::frequency(acceptance_result& into) {
  using enum command;
  const auto code = [](command of) { return static_cast<std::uint8_t>(of); };
  const auto before = link_->ask(code(frequency_query)).number();
  if (!before) return into.add_finding(differs, "The frequency is not answered.");
  const auto highest = link_->go_to_limit(code(frequency_up_1_hz));
  const auto lowest = link_->go_to_limit(code(frequency_down_1_hz));
  // Back: whole hertz first, then tenths.
  auto now = link_->ask(code(frequency_query)).number();
  constexpr int most_steps = 60;
  for (int i = 0; now && i < most_steps && std::abs(*now - *before) > 5; ++i) {
    const bool is_coarse = std::abs(*before - *now) >= 100;
    const bool is_up = *before > *now;
    now = link_
              ->ask(code(is_up ? (is_coarse ? frequency_up_1_hz : frequency_up_0_1_hz)
                               : (is_coarse ? frequency_down_1_hz : frequency_down_0_1_hz)))
              .number();
  }
  const auto in_hz = [](std::int32_t chz) { return static_cast<double>(chz) / 100.0; };
  into.add("before_hz", in_hz(*before));
  into.add("highest_hz", in_hz(highest.value_or(0)));
  into.add("lowest_hz", in_hz(lowest.value_or(0)));
  into.add("after_hz", in_hz(now.value_or(0)));
  if (!now || std::abs(*now - *before) > 5) into.add_finding(differs, "It could not be set back.");
  const int offset_chz = which_->frequency.reply_offset_chz;
  if (highest && lowest) {
    into.add_answer(q::frequency_limits, answered,
                    std::to_string(*lowest) + " and " + std::to_string(*highest) +
                        " in 0.01 Hz, and at further steps the same.");
  }
  const auto is_near = [&](std::optional<std::int32_t> reply, int limit_dhz) {
    constexpr int step_chz = 100;  // steps of 1 Hz may end so far before the limit
    return reply && std::abs(*reply + offset_chz - 10 * limit_dhz) <= step_chz;
  };
  const bool is_as_table =
      is_near(highest, which_->frequency.max_dhz) && is_near(lowest, which_->frequency.min_dhz);
  into.add_finding(is_as_table ? agrees : differs, is_as_table
                                                       ? "The limits are those of the table."
                                                       : "The limits are not those of the table.");
}

void acceptance_run::sample_rate(acceptance_result& into) {
  constexpr std::uint8_t next = 0xD0;
  constexpr std::int64_t measured_ns = 3'000 * ms;
  constexpr double tolerance = 0.1;
  std::size_t codes = 0;
  for (const sample_rate_entry& rate : which_->rates.entries) codes += rate.hz != 0 ? 1U : 0U;
  std::string rates;
  std::string lengths;
  bool is_complete = true;
  for (std::size_t i = 0; i < codes; ++i) {
    const auto code = link_->ask(next).number();
    if (!code || *code < 0 || *code > 9) return into.add_finding(differs, "D0 is not answered.");
    static_cast<void>(link_->start());
    static_cast<void>(link_->survey(measured_ns));  // while the motor spins up
    const stream_survey heard = link_->steady_survey(measured_ns);
    link_->stop();
    const std::string name = "code_" + std::to_string(*code);
    into.add(name + "_hz", heard.sample_rate_hz());
    into.add(name + "_most_samples", heard.most_samples());
    const std::string separator = i == 0 ? "" : ", ";
    rates += separator + std::to_string(*code) + ": " +
             std::to_string(std::lround(heard.sample_rate_hz())) + " Hz";
    lengths += separator + std::to_string(*code) + ": " + std::to_string(heard.most_samples());
    is_complete = is_complete && heard.zero_packets() > 2;
    const auto at = static_cast<std::size_t>(*code);
    const std::uint32_t stated = at < codes ? which_->rates.entries.at(at).hz : 0;
    const double ratio = stated != 0 ? heard.sample_rate_hz() / stated : 0.0;
    if (std::abs(ratio - 1.0) > tolerance) {
      into.add_finding(differs,
                       "The rate behind code " + std::to_string(*code) + " is another one.");
    }
  }
  const answer_state state = is_complete ? answered : not_decided;
  into.add_answer(q::rate_codes, state, rates + ".");
  into.add_answer(q::packet_lengths, state, "At most, by code, " + lengths + " samples.");
  into.add_finding(agrees, "As many steps as there are rates: it is set as before.");
}

void acceptance_run::start_and_stop(acceptance_result& into) {
  const std::int64_t begin_ns = link_->monitor().now_ns();
  const std::int64_t first_ns = link_->start();
  if (first_ns < 0) {
    link_->stop();
    return into.add_finding(differs,
                            which_->motor == motor_kind::dtr
                                ? "No packet came. Does the second plug give power to the motor?"
                                : "No packet came after the start.");
  }
  into.add("first_packet_ms", in_ms(first_ns));
  const double steady_hz = link_->wait_until_steady();
  into.add("frequency_hz", steady_hz);
  if (steady_hz > 0.0) {
    const double steady_ms = in_ms(link_->monitor().now_ns() - begin_ns);
    into.add("steady_after_ms", steady_ms);
    into.add_answer(q::spin_up, answered, spin_up_words(first_ns, steady_ms));
  }
  link_->send(command::forced_stop);
  const std::int64_t forced_ns = link_->wait_for_silence(2'000 * ms);
  into.add_answer(q::forced_stop, answered, forced_ns >= 0 ? "It does." : "It does not.");
  into.add("stops_by_00", std::string(forced_ns >= 0 ? "yes" : "no"));
  if (forced_ns >= 0) into.add("silent_after_00_ms", in_ms(forced_ns));
  static_cast<void>(link_->start());
  static_cast<void>(link_->survey(500 * ms));
  link_->send(command::stop);
  const std::int64_t stopped_ns = link_->wait_for_silence(2'000 * ms);
  if (stopped_ns >= 0) into.add("silent_after_65_ms", in_ms(stopped_ns));
  link_->stop();
  into.add_finding(stopped_ns >= 0 ? agrees : differs,
                   stopped_ns >= 0 ? "It starts and stops." : "It does not stop after 65.");
}

}  // namespace g4lidar
