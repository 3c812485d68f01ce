// SPDX-License-Identifier: MIT
#include "tested_lidar.hpp"

#include <algorithm>
#include <set>
#include <utility>
#include <variant>

#include "g4lidar/core/response.hpp"

namespace g4_tool::acceptance {

std::optional<device_information> information_in(bytes content) noexcept {
  if (content.size() != max_response_content) return std::nullopt;
  return device_information{content[0], content[2], content[1], content[3], {}};
}

tested_lidar::tested_lidar(connector& connects, const run_options& wanted)
    : from(connects),
      options(wanted),
      row(*wanted.model),
      baud_(wanted.baud != 0 ? wanted.baud : wanted.model->bauds[0]) {}

result<void> tested_lidar::open() {
  auto opened = from.connect();
  if (!opened) return tl::unexpected(opened.error());
  if (const auto rate = (*opened)->set_baud(baud_); !rate) return tl::unexpected(rate.error());
  link = std::make_unique<lidar_link>(*std::move(opened), options.is_cancelled, row);
  return {};
}

bool tested_lidar::reopen(std::int64_t wait_ns, bool may_be_cancelled) {
  constexpr std::int64_t retry_ns = 200 * ms;
  link.reset();
  const std::int64_t until_ns = from.now_ns() + wait_ns;
  do {
    static_cast<void>(from.pause(from.now_ns() + retry_ns));
    if (may_be_cancelled && options.is_cancelled && options.is_cancelled()) return false;
    const auto opened = open();
    if (opened) return true;
    why_closed = opened.error();
  } while (from.now_ns() < until_ns);
  return false;
}

bool tested_lidar::find_baud(step_result& result) {
  if (options.baud != 0) return false;
  const auto talks = [this] {
    if (!is_two_way()) return link->wait_for_packet(600 * ms) >= 0;
    link->stop_scan();
    return link->ask(command::device_info).is_response();
  };
  std::set<std::uint32_t> rates;
  for (const model& each : models) rates.insert(each.bauds.begin(), each.bauds.end());
  rates.erase(0);
  rates.insert(baud_);
  for (const std::uint32_t baud : rates) {
    if (link->is_over() || !link->port().set_baud(baud).value_or(false)) break;
    link->read_as(row);
    if (!talks()) continue;
    baud_ = baud;
    result.add("found_baud", baud);
    return true;
  }
  if (!link->is_over()) static_cast<void>(link->port().set_baud(baud_));
  return false;
}

void tested_lidar::identify(const device_information& information) {
  const model& same = with_firmware(*options.model, information);
  if (&same == options.model) return;
  row = same;
  link->read_as(row);
}

void tested_lidar::adapt_layout() {
  const std::size_t sent = link->sample_bytes();
  if (sent == 0 || sent == sample_size(row.samples.layout)) return;
  if (sent != sample_size(row.other_layout)) return;
  row.samples.layout = row.other_layout;
  link->read_as(row);
}

bool tested_lidar::is_same() {
  if (identified.empty()) return true;
  constexpr int tries = 5;
  for (int i = 0; i < tries && !link->is_over(); ++i) {
    if (i > 0) link->stop_scan();  // the answer is lost between packets
    const raw_reply got = link->ask(command::device_info, 1'000 * ms);
    if (information_in(got.content())) return std::ranges::equal(got.content(), identified);
  }
  return false;
}

std::optional<double> tested_lidar::number(const step_result& now, std::string_view fact) const {
  const auto number_in = [fact](const step_result& result) -> std::optional<double> {
    const auto found = std::ranges::find(result.facts, fact, &evidence::name);
    if (found == result.facts.end()) return std::nullopt;
    if (const auto* const whole = std::get_if<std::int64_t>(&found->value))
      return static_cast<double>(*whole);
    if (const auto* const value = std::get_if<double>(&found->value)) return *value;
    return std::get<std::string>(found->value) == "yes" ? 1.0 : 0.0;
  };
  if (const auto here = number_in(now)) return here;
  for (auto each = results.rbegin(); each != results.rend(); ++each) {
    if (const auto earlier = number_in(*each)) return earlier;
  }
  return std::nullopt;
}

}  // namespace g4_tool::acceptance
