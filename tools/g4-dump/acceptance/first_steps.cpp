// SPDX-License-Identifier: MIT
// The steps that change nothing: bridge, listening, identity, queries.
#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <map>
#include <optional>

#include "kit_rows.hpp"

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
void read_numbers(tested_lidar& lidar, step_result& result, const reply_map& replies) {
  const auto number = [&replies](std::uint8_t code) -> std::optional<std::int32_t> {
    const auto found = replies.find(code);
    return found == replies.end() ? std::nullopt : found->second.number();
  };
  result.add("health", replies.contains(0x91) || replies.contains(0x92));
  result.add("motor_settings", replies.contains(0x05) || replies.contains(0x08));
  if (replies.contains(0xD1)) result.add("rate_code", number(0xD1).value_or(-1));
  if (const auto chz = number(0x0D)) result.add("answered_hz", *chz / 100.0);
  if (const std::string errors = health_errors(replies); !errors.empty())
    result.add("health_error", errors);
  const auto offset = number(0x93);
  if (!offset || !lidar.is_two_way()) return;
  const int divisor = lidar.row.zero_angle_divisor != 0 ? lidar.row.zero_angle_divisor : 4;
  lidar.zero_offset_deg = static_cast<double>(*offset) / divisor;
  result.add("zero_offset_deg", *lidar.zero_offset_deg);
}

}  // namespace

void bridge(tested_lidar& lidar, step_result& result) {
  const port_info* const port = lidar.options.port;
  const bool is_known = port != nullptr && port->vendor_id != 0;
  result.find(observed, is_known ? "The USB bridge is known."
                                 : "The connection is no USB port of this computer.");
  if (is_known) {
    result.add("usb", fmt::format("{:04x}:{:04x}", port->vendor_id, port->product_id));
    result.add("product", port->product);
    result.add("driver", port->driver);
  }
  result.add("wanted_baud", lidar.options.baud != 0 ? lidar.options.baud : lidar.row.bauds[0]);
  if (const std::uint32_t got = lidar.link->port().baud(); got != 0) result.add("set_baud", got);
}

void listening(tested_lidar& lidar, step_result& result) {
  const bool is_two_way = lidar.is_two_way();
  const auto listen = [&] {
    if (!is_two_way && lidar.row.motor == motor_kind::dtr) lidar.link->set_dtr(true);
    return is_two_way ? -1 : lidar.link->wait_for_packet(12'000 * ms);
  };
  std::int64_t first_ns = listen();
  if (!is_two_way && first_ns < 0 && lidar.link->sample_bytes() == 0 && lidar.find_baud(result))
    first_ns = listen();
  packet_survey heard = lidar.link->survey(1'000 * ms);
  result.add("sample_bytes", lidar.link->sample_bytes());
  lidar.adapt_layout();
  if (heard.counts.packets == 0) heard = lidar.link->survey(1'000 * ms);
  const bool sends = heard.counts.packets > 0;
  result.add("packets", heard.counts.packets);
  result.add("responses", heard.counts.responses);
  result.add("sends_unasked", sends);
  if (is_two_way) {
    if (sends) lidar.link->stop_scan();
    return;
  }
  if (first_ns >= 0) result.add("first_packet_ms", in_ms(first_ns));
  // A two-way lidar that somebody left scanning looks the same, until it gets a stop.
  lidar.link->send(command::stop);
  lidar.link->listen_for(500 * ms);
  const bool goes_on = lidar.link->wait_for_packet(2'000 * ms) >= 0;
  result.add("sends_after_65", goes_on);
  if (goes_on) result.add("unasked", std::string("packets"));
}

void identity(tested_lidar& lidar, step_result& result) {
  raw_reply got = lidar.link->ask(command::device_info, 1'000 * ms);
  constexpr int more_tries = 2;
  for (int i = 0; i < more_tries && lidar.is_two_way() && !got.is_response(); ++i) {
    if (i > 0 && !lidar.find_baud(result)) break;
    lidar.link->stop_scan();
    got = lidar.link->ask(command::device_info, 1'000 * ms);
  }
  result.add("answers_90", got.is_response());
  if (!got.is_response()) return;
  result.add("answer_ms", in_ms(got.first_ns));
  result.add("reply", got.text());
  result.add("reply_bytes", got.length(20));
  const bytes content = got.content();
  const auto who = information_in(content);
  if (!who) return;
  lidar.identified.assign(content.begin(), content.end());
  result.add("number", who->model);
  result.add("firmware", fmt::format("{}.{}", who->firmware_major, who->firmware_minor));
  result.add("hardware", who->hardware);
  lidar.identify(*who);
}

void queries(tested_lidar& lidar, step_result& result) {
  constexpr int rounds = 3;
  reply_map replies;  // the last one to each
  std::map<std::uint8_t, std::int64_t> slowest_ns;
  for (const query_row& each : query_rows()) {
    for (int i = 0; i < rounds; ++i) {
      raw_reply got = lidar.link->ask(static_cast<command>(each.code));
      if (!got.is_response()) continue;
      slowest_ns[each.code] = std::max(slowest_ns[each.code], got.first_ns);
      replies[each.code] = std::move(got);
    }
  }
  // The silence of a lidar that answers nothing at all shows nothing of its commands.
  const bool is_silent = lidar.identified.empty() && replies.empty();
  if (!lidar.is_two_way()) result.add("queries_answered", replies.size());
  for (const query_row& each : query_rows()) {
    const std::string name(each.name);
    const auto reply = replies.find(each.code);
    const bool is_answered = reply != replies.end();
    if (!is_silent) result.add(name, is_answered ? reply->second.text() : "no");
    if (is_answered) {
      const std::size_t length = reply->second.length(each.length);
      result.add(name + "_ms", in_ms(slowest_ns[each.code]));
      if (length != each.length)
        result.find(differs,
                    fmt::format("{} has {} bytes, expected {}.", name, length, each.length));
    }
    const presence stated = each.by_table(lidar.row);
    if (stated == presence::unknown) {
      result.find(observed, name + (is_answered ? " is answered." : " is not answered."));
    } else if (is_answered != (stated == presence::yes)) {
      result.find(differs,
                  name + (is_answered ? " is answered, although the model does not have it."
                                      : " is not answered."));
    }
  }
  read_numbers(lidar, result, replies);
}

}  // namespace g4_tool::acceptance
