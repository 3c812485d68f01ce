// SPDX-License-Identifier: MIT
// The steps that change nothing: bridge, listening, identity, queries.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <span>

#include "acceptance_run.hpp"
#include "stages.hpp"

namespace g4lidar {
namespace {

using enum acceptance_verdict;
using enum answer_state;
using q = acceptance_question;

/// A query, and whether it is answered by the table.
struct query {
  std::uint8_t code;
  std::string_view name;
  presence expected;
};

presence when(bool has) noexcept { return has ? presence::yes : presence::no; }

using reply_map = std::map<std::uint8_t, raw_reply>;  // by the code of the query

/// The offset of zero in degrees, if it is answered.
std::optional<double> zero_offset(acceptance_result& into, const reply_map& replies,
                                  const model& which, bytes who) {
  const auto zero = replies.find(0x93);
  const auto offset = zero == replies.end() ? std::nullopt : zero->second.number();
  if (!offset) {
    if (which.zero_angle_divisor == 0) {
      into.add_answer(q::zero_offset, not_applicable, "The model does not have it; no answer.");
    }
    return std::nullopt;
  }
  device_information reported{};
  if (who.size() > 3) {
    reported.model = who[0];
    reported.firmware_minor = who[1];
    reported.firmware_major = who[2];
  }
  const int stated = with_firmware(which, reported).zero_angle_divisor;
  const int divisor = stated != 0 ? stated : 4;
  const double offset_deg = static_cast<double>(*offset) / divisor;
  into.add("zero_offset_deg", offset_deg);
  into.add_answer(
      q::zero_offset, answered,
      std::to_string(*offset) + ", in 1/" + std::to_string(divisor) + " degree by the table.");
  return offset_deg;
}

/// What the replies show about the questions; returns the offset of zero in degrees, if there is one. `who` is
/// the content of the answer to 90.
std::optional<double> answer_from(acceptance_result& into, const reply_map& replies,
                                  const model& which, bytes who) {
  const auto words_of_codes = [&](std::span<const std::uint8_t> codes) {
    std::string text;
    for (const std::uint8_t code : codes) {
      const auto found = replies.find(code);
      const std::string reply = found == replies.end() ? "no" : found->second.text();
      text += (text.empty() ? "" : ", ") + digits_of(code, 16, 2) + ": " + reply;
    }
    return text + ".";
  };
  if (which.link == link_kind::one_way) {
    constexpr std::string_view why = "It is a one-way lidar.";
    into.add_answer(q::one_way_answers, answered,
                    replies.empty() ? "To none of 8 queries, of three times each."
                                    : "To " + std::to_string(replies.size()) + " of 8 queries.");
    for (const q each : {q::optional_queries, q::zero_offset, q::health_codes}) {
      into.add_answer(each, not_applicable, why);
    }
    return std::nullopt;
  }
  into.add_answer(q::one_way_answers, not_applicable, "It is a two-way lidar.");
  // The silence of a lidar that answers nothing at all shows nothing.
  if (who.empty() && replies.empty()) return std::nullopt;
  constexpr std::array<std::uint8_t, 3> optional{0xD1, 0x08, 0x05};
  into.add_answer(q::optional_queries, answered, words_of_codes(optional));
  std::string errors;
  for (const std::uint8_t code : {std::uint8_t{0x91}, std::uint8_t{0x92}}) {
    const auto found = replies.find(code);
    if (found == replies.end()) continue;
    const bytes content = found->second.content();
    if (content.size() != 3) continue;
    const unsigned number = load_u16(content, 1);
    if (content[0] != 0 || number != 0) {
      errors += (errors.empty() ? "" : ", ") + std::string("status ") + std::to_string(content[0]) +
                " with code " + digits_of(number, 16, 4);
    }
  }
  into.add_answer(q::health_codes, errors.empty() ? not_decided : answered,
                  errors.empty() ? "This lidar is healthy, or reports nothing." : errors + ".");
  return zero_offset(into, replies, which, who);
}

}  // namespace

void acceptance_run::bridge(acceptance_result& into) {
  if (options_.port != nullptr && options_.port->vendor_id != 0) {
    into.add("usb", usb_id_of(*options_.port));
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
  if (options_.port != nullptr && options_.port->vendor_id != 0) {
    into.add_answer(q::bridge_and_baud, got != 0 ? answered : not_decided,
                    usb_id_of(*options_.port) + " sets " +
                        (got != 0 ? std::to_string(got) : "an unknown rate") + " of " +
                        std::to_string(wanted) + " baud.");
  }
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
  into.add("packets", heard.counts().packets);
  into.add("responses", heard.counts().responses);
  into.add("sample_bytes", link_->monitor().layout().sample_bytes());
  if (!is_two_way()) {
    if (first_ns >= 0) into.add("first_packet_ms", in_ms(first_ns));
    // A two-way lidar that somebody left scanning looks the same, until it gets a stop.
    link_->send(command::stop);
    link_->monitor().listen_for(500 * ms);
    const bool goes_on = link_->wait_for_packet(2'000 * ms) >= 0;
    into.add("sends_after_65", std::string(goes_on ? "yes" : "no"));
    into.add_answer(q::unasked_bytes, goes_on ? answered : not_decided,
                    goes_on ? "It sends packets, and ignores a stop."
                    : heard.counts().packets > 0
                        ? "It was scanning, and obeys a stop."
                        : "It sent no packets: by itself, or without a motor.");
    if (heard.counts().packets > 0 && !goes_on) {
      into.add_finding(differs, "It obeys a stop, as a two-way lidar.");
    }
    return heard.counts().packets > 0
               ? into.add_finding(agrees, "It sends without being asked.")
               : into.add_finding(differs, "It sends no packet without being asked.");
  }
  if (heard.counts().packets == 0) {
    into.add_answer(q::unasked_bytes, not_decided,
                    "It was silent: by itself, or because a program has stopped it.");
    return into.add_finding(agrees, "It is silent until it is asked.");
  }
  into.add_answer(q::unasked_bytes, not_decided,
                  "It was scanning: by itself, or because a program left it so.");
  into.add_finding(observed, "It was scanning, and is stopped.");
  link_->stop();
}

void acceptance_run::identity(acceptance_result& into) {
  const raw_reply got = link_->ask(static_cast<std::uint8_t>(command::device_info), 1'000 * ms);
  const bytes who = got.content();
  if (!is_two_way()) {
    into.add("answers_90", std::string(got.is_response() ? "yes" : "no"));
    if (!got.is_response()) {
      into.add_answer(q::number, not_decided,
                      "It does not answer, and its CT bytes have no number.");
    }
    return got.is_response() ? into.add_finding(differs, "It answers, as a two-way lidar.")
                             : into.add_finding(agrees, "It does not answer.");
  }
  constexpr std::size_t size = 20;
  if (who.size() != size) return into.add_finding(differs, "It does not answer to 90.");
  identified_.assign(who.begin(), who.end());
  into.add("answer_ms", in_ms(got.first_ns));
  into.add("reply", got.text());
  into.add("model_id", who[0]);
  into.add_answer(q::number, answered, "With " + std::to_string(who[0]) + ".");
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
  reply_map replies;  // the last one to each
  for (const query& each : all_queries) {
    int answers = 0;
    std::int64_t slowest_ns = 0;
    for (int i = 0; i < rounds; ++i) {
      raw_reply got = link_->ask(each.code);
      if (!got.is_response()) continue;
      ++answers;
      slowest_ns = std::max(slowest_ns, got.first_ns);
      replies[each.code] = std::move(got);
    }
    const std::string name(each.name);
    into.add(name + "_answers", answers);
    if (answers > 0) {
      into.add(name, replies[each.code].text());
      into.add(name + "_slowest_ms", in_ms(slowest_ns));
    }
    const presence seen = when(answers > 0);
    if (each.expected == presence::unknown) {
      into.add_finding(observed, name + (answers > 0 ? " is answered." : " is not answered."));
    } else if (seen != each.expected) {
      into.add_finding(differs,
                       name + (answers > 0 ? " is answered, although the model does not have it."
                                           : " is not answered."));
    }
  }
  const bool has_health = replies.contains(0x91) || replies.contains(0x92);
  if (has_health != is_two_way())
    into.add_finding(differs, "The health is not that of the kind of link.");
  zero_offset_deg_ = answer_from(into, replies, *which_, identified_);
}

}  // namespace g4lidar
