// SPDX-License-Identifier: MIT
#include "doctor_answers.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "g4lidar/bytes.hpp"

namespace g4_dump {
namespace {

using namespace g4lidar;

constexpr std::int64_t ms = 1'000'000;
constexpr int rounds = 5;
constexpr std::array questions{command::device_info,          command::health,
                               command::health_vendor,        command::frequency_query,
                               command::ranging_query,        command::low_power_query,
                               command::motor_direction_query};
/// A single answer this late stands for a line that was held up once.
constexpr std::int64_t very_late_ns = 400 * ms;
/// Out of a series, so many silent questions at its end are a line that has died.
constexpr unsigned dead_line = 6;

bool may_be_unknown(command code) noexcept {
  return code == command::health || code == command::health_vendor ||
         code == command::motor_direction_query || code == command::low_power_query;
}

/// The view of a response with this content, for its own readers of it.
template <class Read>
auto read_content(response_kind kind, const std::vector<std::uint8_t>& content, Read read)
    -> decltype(read(std::declval<const response_view&>())) {
  for (const response_layout& layout : response_layouts) {
    if (layout.kind != kind) continue;
    std::vector<std::uint8_t> frame(layout.header.begin(), layout.header.end());
    frame.insert(frame.end(), content.begin(), content.end());
    if (const auto view = response_view::from(bytes(frame))) return read(*view);
  }
  return std::nullopt;
}

}  // namespace

void question_book::add(exchange made) { made_.push_back(std::move(made)); }

unsigned question_book::answered() const noexcept {
  return static_cast<unsigned>(
      std::count_if(made_.begin(), made_.end(), [](const exchange& e) { return e.is_answered(); }));
}

std::optional<std::vector<std::uint8_t>> question_book::usual(command code) const {
  std::optional<std::vector<std::uint8_t>> best;
  std::ptrdiff_t most = 0;
  for (const exchange& one : made_) {
    if (one.asked != code || !one.is_answered()) continue;
    const auto same = std::count_if(made_.begin(), made_.end(), [&](const exchange& other) {
      return other.asked == code && other.is_answered() && other.content == one.content;
    });
    if (same > most) {
      most = same;
      best = one.content;
    }
  }
  return best;
}

bool question_book::is_odd(const exchange& one) const {
  if (!one.is_answered() || one.asked == command::health || one.asked == command::health_vendor) {
    return false;  // a health may change
  }
  const auto expected = usual(one.asked);
  return expected && *expected != one.content;
}

bool question_book::is_unknown(command code) const {
  if (!may_be_unknown(code)) return false;
  return std::none_of(made_.begin(), made_.end(), [&](const exchange& e) {
    return e.asked == code && (e.is_answered() || e.wrong > 0);
  });
}

question_book::tally question_book::count() const {
  tally sum;
  for (const exchange& one : made_) {
    if (one.packets > 0 || one.booted) continue;
    if (one.is_answered()) {
      sum.late += one.latency_ns() > late_ns ? 1U : 0U;
      sum.very_late += one.latency_ns() > very_late_ns ? 1U : 0U;
      sum.twice += one.copies > 0 ? 1U : 0U;
      sum.damaged += is_odd(one) ? 1U : 0U;
      sum.missing_at_end = 0;
      sum.missing_before = sum.missing;
    } else if (one.heard_nothing()) {
      ++sum.missing_at_end;
      if (!is_unknown(one.asked)) ++sum.missing;
    } else if (one.wrong == 0) {
      ++sum.damaged;
      sum.missing_at_end = 0;
    }
    sum.wrong += one.wrong > 0 ? 1U : 0U;
  }
  return sum;
}

bool question_book::is_clear() const {
  const tally sum = count();
  return sum.late >= 4 || sum.wrong >= 6 || sum.missing_at_end >= dead_line;
}

bool question_book::has_died() const {
  const tally sum = count();
  return answered() > 0 && sum.missing_at_end >= dead_line && sum.missing_before <= 1;
}

void question_book::judge(stage_report& report) const {
  const tally sum = count();
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
  const bool died = has_died();
  // Who answers late leaves questions without an answer, and gives wrong ones to the next.
  const bool is_late = sum.late >= 2;
  // The first answer of all may have waited for the end of a boot.
  const bool is_held_up = sum.very_late == 1 && made_.front().latency_ns() <= very_late_ns;
  if (is_late) report.find(diagnosis::answers_late);
  if (died || (!is_late && is_held_up)) report.find(diagnosis::stalls);
  if (is_late || died) return;
  if (sum.wrong > 0 && !is_held_up) report.find(diagnosis::answers_wrong);
  if (sum.twice > 0) report.find(diagnosis::answers_twice);
  if (sum.missing > 0 && !is_held_up) report.find(diagnosis::answers_missing);
}

device_portrait question_book::portrait() const {
  device_portrait drawn;
  if (const auto content = usual(command::device_info)) {
    drawn.information = read_content(response_kind::device_info, *content,
                                     [](const auto& view) { return view.as_device_info(); });
  }
  for (const command code : {command::health, command::health_vendor}) {
    const auto content = usual(code);
    if (!content || drawn.health) continue;
    drawn.health = read_content(response_kind::health, *content,
                                [](const auto& view) { return view.as_health(); });
  }
  if (const auto content = usual(command::frequency_query)) {
    drawn.frequency_chz = read_content(response_kind::frequency, *content,
                                       [](const auto& view) { return view.as_frequency_chz(); });
  }
  if (const auto content = usual(command::ranging_query); content && content->size() == 1) {
    drawn.ranging = reply_byte<ranging_frequency>(content->front());
  }
  return drawn;
}

void ask_all(ear& line, question_book& book, std::int64_t first_latency_ns) {
  const std::int64_t patience_ns =
      std::max<std::int64_t>(600 * ms, 2 * first_latency_ns + 300 * ms);
  bool has_waited_long = false;
  std::array<int, questions.size()> silent{};
  for (int round = 0; round < rounds && !line.is_over() && !book.is_clear(); ++round) {
    for (std::size_t i = 0; i < questions.size() && !line.is_over(); ++i) {
      const bool is_known = silent[i] < 0;
      if (silent[i] >= 2 && may_be_unknown(questions[i])) continue;
      exchange made = line.ask(questions[i], patience_ns);
      if (made.packets > 0) return book.add(std::move(made));  // it scans: that comes first
      if (made.heard_nothing() && round > 0 && is_known && !has_waited_long) {
        has_waited_long = true;  // a line that is held up gives it in the end
        const std::int64_t asked_ns = made.asked_ns;
        std::int64_t until_ns = line.now_ns() + 3'000 * ms;
        listener to;
        to.event = [&](const heard& came) {
          const auto* response = std::get_if<response_view>(&came.what);
          if (response == nullptr || response->kind() != answer_kind(questions[i])) return;
          made.answered_ns = came.arrival_ns;
          made.content.assign(response->content().begin(), response->content().end());
          until_ns = std::min(until_ns, came.arrival_ns + 35 * ms);
        };
        line.listen(until_ns, to);
        made.asked_ns = asked_ns;
      }
      silent[i] = made.is_answered() ? -100 : silent[i] + 1;
      book.add(std::move(made));
    }
  }
}

}  // namespace g4_dump
