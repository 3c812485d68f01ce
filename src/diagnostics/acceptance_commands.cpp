// SPDX-License-Identifier: MIT
// The steps with commands: bridge, listening, identity, commands, protection, frequency, sample rate,
// start and stop, DTR.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "acceptance_run.hpp"

namespace g4lidar {
namespace {

using enum acceptance_verdict;

double in_ms(std::int64_t ns) noexcept { return static_cast<double>(ns) / 1e6; }

std::string hex(unsigned value, unsigned digits) {
  std::string text;
  for (unsigned i = digits; i > 0; --i) text += "0123456789abcdef"[value >> (4 * (i - 1)) & 15U];
  return text;
}

/// A query, and whether it is answered by the table.
struct query {
  std::uint8_t code;
  std::string_view name;
  presence expected;
};

presence when(bool has) noexcept { return has ? presence::yes : presence::no; }

}  // namespace

void acceptance_run::bridge(acceptance_result& into) {
  if (options_.port != nullptr && options_.port->vendor_id != 0) {
    into.add("usb", hex(options_.port->vendor_id, 4) + ":" + hex(options_.port->product_id, 4));
    into.add("product", options_.port->product);
    into.add("driver", options_.port->driver);
    into.add_finding(observed, "The USB bridge is known.");
  } else {
    into.add_finding(observed, "The connection is no USB port of this computer.");
  }
  constexpr double remarkable = 0.015;
  const std::uint32_t wanted = baud();
  const std::uint32_t got = link_->monitor().port().baud();
  into.add("wanted_baud", wanted);
  into.add("set_baud", got);
  if (got == 0) return;
  if (std::abs(static_cast<double>(got) / wanted - 1.0) > remarkable) {
    into.add_finding(differs, "The system set another baud rate.");
  }
}

void acceptance_run::listening(acceptance_result& into) {
  const std::int64_t time_ns = is_two_way() ? 1'000 * ms : 12'000 * ms;
  if (!is_two_way() && which_->motor == motor_kind::dtr) static_cast<void>(link_->set_dtr(true));
  const std::int64_t first_ns = is_two_way() ? -1 : link_->wait_for_packet(time_ns);
  const stream_survey heard = link_->survey(1'000 * ms);
  into.add("packets", heard.packets());
  into.add("responses", heard.unasked_responses());
  into.add("sample_bytes", link_->monitor().layout().sample_bytes());
  if (!is_two_way()) {
    if (first_ns >= 0) into.add("first_packet_ms", in_ms(first_ns));
    return heard.packets() > 0
               ? into.add_finding(agrees, "It sends without being asked.")
               : into.add_finding(differs, "It sends no packet without being asked.");
  }
  if (heard.packets() == 0) return into.add_finding(agrees, "It is silent until it is asked.");
  into.add_finding(observed, "It was scanning, and is stopped.");
  link_->stop();
}

void acceptance_run::identity(acceptance_result& into) {
  const raw_reply got = link_->ask(static_cast<std::uint8_t>(command::device_info), 1'000 * ms);
  const bytes who = got.content();
  if (!is_two_way()) {
    into.add("answers_90", std::string(got.is_response() ? "yes" : "no"));
    return got.is_response() ? into.add_finding(differs, "It answers, as a two-way lidar.")
                             : into.add_finding(agrees, "It does not answer.");
  }
  constexpr std::size_t size = 20;
  if (who.size() != size) return into.add_finding(differs, "It does not answer to 90.");
  identified_.assign(who.begin(), who.end());
  into.add("answer_ms", in_ms(got.first_ns));
  into.add("reply", got.text());
  into.add("model_id", who[0]);
  into.add("firmware", std::to_string(who[2]) + "." + std::to_string(who[1]));
  into.add("hardware", who[3]);
  const bool is_known =
      who[0] == which_->ids[0] || (which_->ids[1] != 0 && who[0] == which_->ids[1]);
  into.add_finding(is_known ? agrees : differs, is_known ? "The number is that of the model."
                                                         : "The number is not that of the model.");
}

void acceptance_run::queries(acceptance_result& into) {
  const bool is_g = which_->motor == motor_kind::command && is_two_way();
  const std::array all_queries{
      query{0x91, "health_91", presence::unknown},
      query{0x92, "health_92", presence::unknown},
      query{0x0D, "frequency_0d", when(which_->frequency.max_dhz != 0)},
      query{0xD1, "sample_rate_d1",
            which_->rates.is_settable ? presence::yes
            : is_g                    ? presence::unknown
                                      : presence::no},
      query{0x93, "zero_angle_93", when(which_->zero_angle_divisor != 0)},
      query{0x98, "pitch_98", is_g ? presence::unknown : presence::no},
      query{0x05, "low_power_05", is_g ? presence::unknown : presence::no},
      query{0x08, "direction_08", is_g ? presence::unknown : presence::no},
  };
  constexpr int rounds = 3;
  bool has_health = false;
  for (const query& each : all_queries) {
    int answered = 0;
    std::int64_t slowest_ns = 0;
    raw_reply last;
    for (int i = 0; i < rounds; ++i) {
      raw_reply got = link_->ask(each.code);
      if (!got.is_response()) continue;
      ++answered;
      slowest_ns = std::max(slowest_ns, got.first_ns);
      last = std::move(got);
    }
    const std::string name(each.name);
    into.add(name + "_answers", answered);
    if (answered > 0) {
      into.add(name, last.text());
      into.add(name + "_slowest_ms", in_ms(slowest_ns));
    }
    has_health = has_health || (answered > 0 && (each.code == 0x91 || each.code == 0x92));
    const presence seen = when(answered > 0);
    if (each.expected == presence::unknown) {
      into.add_finding(observed, name + (answered > 0 ? " is answered." : " is not answered."));
    } else if (seen != each.expected) {
      into.add_finding(differs,
                       name + (answered > 0 ? " is answered, although the model does not have it."
                                            : " is not answered."));
    }
  }
  if (has_health != is_two_way())
    into.add_finding(differs, "The health is not that of the kind of link.");
}

void acceptance_run::protection(acceptance_result& into) {
  constexpr std::uint8_t toggle = 0xD9;
  const raw_reply first = link_->ask(toggle);
  into.add("first_reply", first.text());
  if (!first.number()) {
    return into.add_finding(which_->protection == presence::yes ? differs : observed,
                            "D9 is not answered.");
  }
  // 1 means off: another one only if the first switched it on.
  raw_reply last = first;
  if (first.number() == 0) last = link_->ask(toggle);
  into.add("last_reply", last.text());
  const bool is_off = last.number() == 1;
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
  for (std::size_t i = 0; i < codes; ++i) {
    const auto code = link_->ask(next).number();
    if (!code || *code < 0 || *code > 9) return into.add_finding(differs, "D0 is not answered.");
    static_cast<void>(link_->start());
    static_cast<void>(link_->survey(measured_ns));  // while the motor spins up
    const stream_survey heard = link_->survey(measured_ns);
    link_->stop();
    const std::string name = "code_" + std::to_string(*code);
    into.add(name + "_hz", heard.sample_rate_hz());
    into.add(name + "_most_samples", heard.most_samples());
    const auto at = static_cast<std::size_t>(*code);
    const std::uint32_t stated = at < codes ? which_->rates.entries.at(at).hz : 0;
    const double ratio = stated != 0 ? heard.sample_rate_hz() / stated : 0.0;
    if (std::abs(ratio - 1.0) > tolerance) {
      into.add_finding(differs,
                       "The rate behind code " + std::to_string(*code) + " is another one.");
    }
  }
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
  // The time until two measurements of half a second agree within 3 %.
  double last_hz = 0.0;
  constexpr int most = 24;
  for (int i = 0; i < most; ++i) {
    const double now_hz = link_->survey(500 * ms).frequency_hz();
    const bool is_steady = last_hz > 0.0 && std::abs(now_hz / last_hz - 1.0) < 0.03;
    last_hz = now_hz;
    if (!is_steady) continue;
    into.add("steady_after_ms", in_ms(link_->monitor().now_ns() - begin_ns));
    break;
  }
  into.add("frequency_hz", last_hz);
  link_->send(static_cast<std::uint8_t>(command::forced_stop));
  const std::int64_t forced_ns = link_->wait_for_silence(2'000 * ms);
  into.add("stops_by_00", std::string(forced_ns >= 0 ? "yes" : "no"));
  if (forced_ns >= 0) into.add("silent_after_00_ms", in_ms(forced_ns));
  static_cast<void>(link_->start());
  static_cast<void>(link_->survey(500 * ms));
  link_->send(static_cast<std::uint8_t>(command::stop));
  const std::int64_t stopped_ns = link_->wait_for_silence(2'000 * ms);
  if (stopped_ns >= 0) into.add("silent_after_65_ms", in_ms(stopped_ns));
  link_->stop();
  into.add_finding(stopped_ns >= 0 ? agrees : differs,
                   stopped_ns >= 0 ? "It starts and stops." : "It does not stop after 65.");
}

void acceptance_run::dtr(acceptance_result& into) {
  constexpr std::int64_t patience_ns = 5'000 * ms;
  if (is_two_way()) {
    static_cast<void>(link_->monitor().stop());
    if (!link_->set_dtr(true)) return into.add_finding(not_done, "The connection has no DTR.");
    link_->monitor().listen_for(500 * ms);
    link_->send(static_cast<std::uint8_t>(command::start));
    const bool needs_no_edge = link_->wait_for_packet(patience_ns) >= 0;
    into.add("starts_without_edge", std::string(needs_no_edge ? "yes" : "no"));
    static_cast<void>(link_->monitor().stop());
  } else if (!link_->set_dtr(true)) {
    return into.add_finding(not_done, "The connection has no DTR.");
  }
  const bool turns = link_->start() >= 0;
  into.add("starts_with_edge", std::string(turns ? "yes" : "no"));
  static_cast<void>(link_->set_dtr(false));
  const std::int64_t silent_ns = link_->wait_for_silence(patience_ns);
  into.add("low_silences", std::string(silent_ns >= 0 ? "yes" : "no"));
  if (silent_ns >= 0) into.add("silent_after_ms", in_ms(silent_ns));
  const std::uint64_t boots = link_->monitor().boots();
  const std::uint64_t responses = link_->monitor().counts().responses;
  static_cast<void>(link_->set_dtr(true));
  const std::int64_t again_ns = link_->wait_for_packet(patience_ns);
  into.add("high_resumes", std::string(again_ns >= 0 ? "yes" : "no"));
  if (again_ns >= 0) into.add("resumes_after_ms", in_ms(again_ns));
  const bool has_booted =
      link_->monitor().boots() != boots || link_->monitor().counts().responses != responses;
  into.add("boots_again", std::string(has_booted ? "yes" : "no"));
  const bool is_driven = silent_ns >= 0;
  const bool as_table = is_driven == (which_->motor == motor_kind::dtr);
  into.add_finding(as_table ? agrees : differs,
                   is_driven ? "DTR stops it." : "DTR does not stop it.");
  if (is_driven) {
    into.add_finding(observed, has_booted
                                   ? "DTR switches the supply of the lidar."
                                   : "DTR switches the motor, or the sending, and not the supply.");
  }
  link_->stop();
}

}  // namespace g4lidar
