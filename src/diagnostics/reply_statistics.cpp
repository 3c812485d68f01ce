// SPDX-License-Identifier: MIT
#include "reply_statistics.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/request.hpp"

namespace g4lidar {
namespace {

constexpr int rounds = 5;
struct question {
  command code;
  request_kind of;  // a lidar has it if it has this request
};
constexpr std::array all_questions{
    question{command::device_info, request_kind::device_info},
    question{command::health, request_kind::health},
    question{command::health_vendor, request_kind::health},
    question{command::frequency_query, request_kind::get_scan_frequency},
    question{command::sample_rate_query, request_kind::get_sample_rate},
    question{command::low_power_query, request_kind::get_low_power},
    question{command::motor_direction_query, request_kind::get_direction},
    question{command::zero_angle, request_kind::zero_angle},
    question{command::pitch, request_kind::pitch}};
/// A reply that takes longer is late.
constexpr std::int64_t late_ns = 150 * ms;
/// A single reply with this delay is caused by a stall of the link.
constexpr std::int64_t very_late_ns = 400 * ms;
/// The number of commands without a reply at the end of a series that means a dead link.
constexpr unsigned unanswered_of_dead_link = 6;

std::vector<command> questions_to(const model& model) {
  std::vector<command> all;
  for (const question& each : all_questions) {
    if (has_request(model, each.of)) all.push_back(each.code);
  }
  return all;
}

bool may_be_unknown(command code, const model& model) noexcept {
  switch (code) {
    case command::device_info:
    case command::frequency_query:
      return false;
    case command::sample_rate_query:
      return !model.rates.is_settable;
    default:
      return true;
  }
}

}  // namespace

std::ptrdiff_t reply_statistics::answered() const noexcept {
  return std::ranges::count_if(made_, &exchange::is_answered);
}

bytes reply_statistics::usual(command code) const {
  bytes best;
  std::ptrdiff_t most = 0;
  for (const exchange& one : made_) {
    if (one.asked != code || !one.is_answered()) continue;
    const auto same = std::count_if(made_.begin(), made_.end(), [&](const exchange& other) {
      return other.asked == code && other.reply == one.reply;
    });
    if (same <= most) continue;
    most = same;
    best = one.reply;
  }
  return best;
}

bool reply_statistics::is_odd(const exchange& one) const {
  if (!one.is_answered() || one.asked == command::health || one.asked == command::health_vendor) {
    return false;  // a health may change
  }
  return !std::ranges::equal(usual(one.asked), one.reply);
}

// What a device answers whose number its model does not have, nobody knows.
bool reply_statistics::is_unknown(command code, const model& model) const {
  const auto stated = response_view::from(usual(command::device_info));
  const auto who = stated ? stated->as_device_info() : std::nullopt;
  const bool is_other = knows_less_ || (who && !detail::may_report(model, who->model));
  if (!may_be_unknown(code, model) && !is_other) return false;
  return std::none_of(made_.begin(), made_.end(), [&](const exchange& e) {
    return e.asked == code && (e.is_answered() || e.wrong > 0);
  });
}

bool reply_statistics::has_mute_question(const model& model) const {
  if (answered() == 0) return false;
  if (lacks_zero(model)) return true;
  return std::ranges::any_of(made_, [&](const exchange& one) {
    const auto is_same = [&](const exchange& other) { return other.asked == one.asked; };
    const auto is_heard = [&](const exchange& other) {
      return is_same(other) && !other.heard_nothing();
    };
    return !is_unknown(one.asked, model) && std::ranges::count_if(made_, is_same) > 1 &&
           std::ranges::none_of(made_, is_heard);
  });
}

reply_statistics::tally reply_statistics::count(const model& model) const {
  tally sum;
  for (const exchange& one : made_) {
    if (one.packets > 0 || one.is_disturbed) continue;
    if (one.is_answered()) {
      sum.late += one.latency_ns() > late_ns ? 1U : 0U;
      sum.very_late += one.latency_ns() > very_late_ns ? 1U : 0U;
      sum.twice += one.copies > 0 ? 1U : 0U;
      sum.damaged += is_odd(one) ? 1U : 0U;
      sum.missing_at_end = 0;
      sum.missing_before = sum.missing;
    } else if (one.heard_nothing()) {
      ++sum.missing_at_end;
      if (!is_unknown(one.asked, model)) ++sum.missing;
    } else if (one.wrong == 0) {
      ++sum.damaged;
      sum.missing_at_end = 0;
    }
    sum.wrong += one.wrong > 0 ? 1U : 0U;
  }
  return sum;
}

bool reply_statistics::is_clear(const model& model) const {
  const tally sum = count(model);
  return sum.late >= 4 || sum.wrong >= 6 || sum.missing_at_end >= unanswered_of_dead_link;
}

bool reply_statistics::has_died(const model& model) const {
  const tally sum = count(model);
  return answered() > 0 && sum.missing_at_end >= unanswered_of_dead_link && sum.missing_before <= 1;
}

void reply_statistics::judge(stage_report& report, bool host_paused, const model& model) const {
  const tally sum = count(model);
  std::int64_t slowest_ns = 0;
  for (const exchange& e : made_) {
    if (e.is_answered()) slowest_ns = std::max(slowest_ns, e.latency_ns());
  }
  report.add("asked", made_.size());
  report.add("answered", answered());
  report.add("slowest_ms", static_cast<double>(slowest_ns) / 1e6);
  for (const auto& [name, value] :
       {std::pair("late", sum.late), std::pair("wrong", sum.wrong), std::pair("twice", sum.twice),
        std::pair("missing", sum.missing), std::pair("damaged", sum.damaged)}) {
    if (value > 0) report.add(name, value);
  }
  const bool died = has_died(model);
  // Late replies leave commands without a reply, and count as wrong replies to the next command.
  const bool is_late = sum.late >= 2;
  // The very first reply may have waited for the end of a boot.
  const bool is_held_up = sum.very_late == 1 && made_.front().latency_ns() <= very_late_ns;
  const bool is_of_host = host_paused && 2 * static_cast<std::ptrdiff_t>(sum.late) < answered();
  if (is_late) report.find(is_of_host ? diagnosis::host_busy : diagnosis::answers_late);
  if (died || (!is_late && is_held_up && !is_of_host)) report.find(diagnosis::stalls);
  if (is_late || died) return;
  if (sum.wrong > 0 && !is_held_up) report.find(diagnosis::answers_wrong);
  if (sum.twice > 0) report.find(diagnosis::answers_twice);
  if (sum.missing > 0 && !is_held_up) report.find(diagnosis::answers_missing);
  if (!knows_less_ && lacks_zero(model)) report.find(diagnosis::no_zero_angle);
}

bool reply_statistics::lacks_zero(const model& model) const {
  const bool has_asked =
      std::ranges::find(made_, command::zero_angle, &exchange::asked) != made_.end();
  if (!has_asked || answered() == 0 || !has_request(model, request_kind::zero_angle)) return false;
  const bytes reply = usual(command::zero_angle);
  const auto heard = response_view::from(reply, model.samples.has_angle_replies);
  return !heard || !zero_angle_of(*heard, model);
}

void device_snapshot::take(const response_view& reply) {
  if (const auto found = reply.as_device_info()) information = found;
  if (const auto found = reply.as_health()) condition = found;
}

void device_snapshot::take_setting(command asked, const response_view& reply, const model& model) {
  const auto chz = reply.as_frequency_chz();
  const bool is_step =
      asked >= command::frequency_up_0_1_hz && asked <= command::frequency_down_1_hz;
  if (chz && (asked == command::frequency_query || is_step)) {
    const int true_chz = int{*chz} + model.frequency.reply_offset_chz;
    frequency = scan_frequency{static_cast<std::uint16_t>(std::max(true_chz, 0))};
  }
  const auto value = reply.as_byte();
  if (value && (asked == command::sample_rate_query || asked == command::sample_rate_next)) {
    const std::uint32_t hz = rate_hz_of_code(model, *value);
    if (hz != 0) sample_rate_hz = hz;
  }
  if (asked == command::zero_angle) {
    if (const auto found = zero_angle_of(reply, model)) zero = found;
  }
}

device_snapshot reply_statistics::snapshot(const model& model) const {
  device_snapshot known;
  for (const command code : questions_to(model)) {
    const auto reply = response_view::from(usual(code), model.samples.has_angle_replies);
    if (!reply || (code == command::health_vendor && known.condition)) continue;
    known.take(*reply);
    known.take_setting(code, *reply, model);
  }
  return known;
}

void ask_all(link_monitor& link, reply_statistics& replies, const model& model,
             std::int64_t first_latency_ns) {
  const std::vector<command> questions = questions_to(model);
  const std::int64_t patience_ns =
      std::max<std::int64_t>(600 * ms, 2 * first_latency_ns + 300 * ms);
  bool has_waited_long = false;
  std::array<int, all_questions.size()> silent{};
  for (int round = 0; round < rounds && !link.is_over() && !replies.is_clear(model); ++round) {
    for (std::size_t i = 0; i < questions.size() && !link.is_over(); ++i) {
      const bool is_known = silent[i] < 0;
      if (silent[i] >= 2 && may_be_unknown(questions[i], model)) continue;
      exchange made = link.ask(questions[i], patience_ns);
      if (made.packets > 0) return replies.add(std::move(made));  // it scans: that is handled first
      if (made.heard_nothing() && round > 0 && is_known && !has_waited_long) {
        has_waited_long = true;  // a link that stalls delivers it at the end
        link.await(made, 3'000 * ms);
      }
      silent[i] = made.is_answered() ? -100 : silent[i] + 1;
      replies.add(std::move(made));
    }
  }
}

}  // namespace g4lidar
