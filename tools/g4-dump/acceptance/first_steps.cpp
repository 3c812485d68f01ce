// SPDX-License-Identifier: MIT
// The steps that change nothing: bridge, listening, identity, queries.
#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <map>
#include <optional>

#include "rows.hpp"

namespace g4_tool::acceptance {
namespace {

using enum finding;

using reply_map = std::map<std::uint8_t, raw_reply>;  // by the code of the query

/// What the answers to 91 and 92 report.
std::string health_errors(const reply_map& replies) {
  std::string errors;
  for (const std::uint8_t code : {std::uint8_t{0x91}, std::uint8_t{0x92}}) {
    const auto found = replies.find(code);
    if (found == replies.end() || found->second.length(3) != 3) continue;
    const bytes content = found->second.content();
    const unsigned number = load_u16(content, 1);
    if (content[0] == 0 && number == 0) continue;
    errors +=
        fmt::format("{}status {} with code {:04x}", errors.empty() ? "" : ", ", content[0], number);
  }
  return errors;
}

/// What the numbers in the answers mean.
void read_numbers(subject& of, step_result& into, const reply_map& replies) {
  const auto number = [&replies](std::uint8_t code) -> std::optional<std::int32_t> {
    const auto found = replies.find(code);
    return found == replies.end() ? std::nullopt : found->second.number();
  };
  into.add("health", replies.contains(0x91) || replies.contains(0x92));
  into.add("motor_settings", replies.contains(0x05) || replies.contains(0x08));
  if (replies.contains(0xD1)) into.add("rate_code", number(0xD1).value_or(-1));
  if (const auto chz = number(0x0D)) into.add("answered_hz", *chz / 100.0);
  if (const std::string errors = health_errors(replies); !errors.empty())
    into.add("health_error", errors);
  const auto offset = number(0x93);
  if (!offset || !of.is_two_way()) return;
  const int divisor = of.row.zero_angle_divisor != 0 ? of.row.zero_angle_divisor : 4;
  of.zero_offset_deg = static_cast<double>(*offset) / divisor;
  into.add("zero_offset_deg", *of.zero_offset_deg);
}

}  // namespace

void bridge(subject& of, step_result& into) {
  const port_info* const port = of.options.port;
  const bool is_known = port != nullptr && port->vendor_id != 0;
  into.find(observed, is_known ? "The USB bridge is known."
                               : "The connection is no USB port of this computer.");
  if (is_known) {
    into.add("usb", fmt::format("{:04x}:{:04x}", port->vendor_id, port->product_id));
    into.add("product", port->product);
    into.add("driver", port->driver);
  }
  into.add("wanted_baud", of.options.baud != 0 ? of.options.baud : of.row.bauds[0]);
  if (const std::uint32_t got = of.link->port().baud(); got != 0) into.add("set_baud", got);
}

void listening(subject& of, step_result& into) {
  const bool is_two_way = of.is_two_way();
  const auto listen = [&] {
    if (!is_two_way && of.row.motor == motor_kind::dtr) of.link->set_dtr(true);
    return is_two_way ? -1 : of.link->wait_for_packet(12'000 * ms);
  };
  std::int64_t first_ns = listen();
  if (!is_two_way && first_ns < 0 && of.link->sample_bytes() == 0 && of.find_baud(into))
    first_ns = listen();
  packet_survey heard = of.link->survey(1'000 * ms);
  into.add("sample_bytes", of.link->sample_bytes());
  of.adapt_layout();
  if (heard.counts.packets == 0) heard = of.link->survey(1'000 * ms);
  const bool sends = heard.counts.packets > 0;
  into.add("packets", heard.counts.packets);
  into.add("responses", heard.counts.responses);
  into.add("sends_unasked", sends);
  if (is_two_way) {
    if (sends) of.link->stop_scan();
    return;
  }
  if (first_ns >= 0) into.add("first_packet_ms", in_ms(first_ns));
  // A two-way lidar that somebody left scanning looks the same, until it gets a stop.
  of.link->send(command::stop);
  of.link->listen_for(500 * ms);
  const bool goes_on = of.link->wait_for_packet(2'000 * ms) >= 0;
  into.add("sends_after_65", goes_on);
  if (goes_on) into.add("unasked", std::string("packets"));
}

void identity(subject& of, step_result& into) {
  raw_reply got = of.link->ask(command::device_info, 1'000 * ms);
  constexpr int more_tries = 2;
  for (int i = 0; i < more_tries && of.is_two_way() && !got.is_response(); ++i) {
    if (i > 0 && !of.find_baud(into)) break;
    of.link->stop_scan();
    got = of.link->ask(command::device_info, 1'000 * ms);
  }
  into.add("answers_90", got.is_response());
  if (!got.is_response()) return;
  into.add("answer_ms", in_ms(got.first_ns));
  into.add("reply", got.text());
  into.add("reply_bytes", got.length(20));
  const bytes content = got.content();
  const auto who = information_in(content);
  if (!who) return;
  of.identified.assign(content.begin(), content.end());
  into.add("number", who->model);
  into.add("firmware", fmt::format("{}.{}", who->firmware_major, who->firmware_minor));
  into.add("hardware", who->hardware);
  of.identify(*who);
}

void queries(subject& of, step_result& into) {
  constexpr int rounds = 3;
  reply_map replies;  // the last one to each
  std::map<std::uint8_t, std::int64_t> slowest_ns;
  for (const query_row& each : query_rows()) {
    for (int i = 0; i < rounds; ++i) {
      raw_reply got = of.link->ask(static_cast<command>(each.code));
      if (!got.is_response()) continue;
      slowest_ns[each.code] = std::max(slowest_ns[each.code], got.first_ns);
      replies[each.code] = std::move(got);
    }
  }
  // The silence of a lidar that answers nothing at all shows nothing of its commands.
  const bool is_silent = of.identified.empty() && replies.empty();
  if (!of.is_two_way()) into.add("queries_answered", replies.size());
  for (const query_row& each : query_rows()) {
    const std::string name(each.name);
    const auto reply = replies.find(each.code);
    const bool is_answered = reply != replies.end();
    if (!is_silent) into.add(name, is_answered ? reply->second.text() : "no");
    if (is_answered) {
      const std::size_t length = reply->second.length(each.length);
      into.add(name + "_ms", in_ms(slowest_ns[each.code]));
      if (length != each.length)
        into.find(differs, fmt::format("{} has {} bytes, expected {}.", name, length, each.length));
    }
    const presence stated = each.by_table(of.row);
    if (stated == presence::unknown) {
      into.find(observed, name + (is_answered ? " is answered." : " is not answered."));
    } else if (is_answered != (stated == presence::yes)) {
      into.find(differs, name + (is_answered ? " is answered, although the model does not have it."
                                             : " is not answered."));
    }
  }
  read_numbers(of, into, replies);
}

}  // namespace g4_tool::acceptance
