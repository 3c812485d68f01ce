// SPDX-License-Identifier: MIT
// The one runner of all steps.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "kit_rows.hpp"

namespace g4_tool::acceptance {
namespace {

constexpr std::array<std::string_view, 4> findings{"agrees", "observed", "not_done", "differs"};

/// "no", "5", "5.9 to 6.1", "at most 40".
std::string words_of(const expected& right, bool is_yes_or_no) {
  if (is_yes_or_no) return right.least > 0.0 ? "yes" : "no";
  const auto number = [](double value) { return fmt::format("{:.6g}", value); };
  if (right.least == right.most) return number(right.least);
  if (std::isinf(right.least)) return "at most " + number(right.most);
  if (std::isinf(right.most)) return "at least " + number(right.least);
  return number(right.least) + " to " + number(right.most);
}

/// Compares each fact with what is expected of it.
void check(const tested_lidar& lidar, step_result& result) {
  std::string not_stated;
  for (const check_row& row : check_rows()) {
    const auto fact = std::ranges::find(result.facts, row.fact, &evidence::name);
    if (row.of != result.of || fact == result.facts.end()) continue;
    const expected right = row.by_table({lidar, result});
    if (!right.is_known) {
      not_stated +=
          fmt::format("{}{} {}", not_stated.empty() ? "" : ", ", fact->name, fact->text());
      continue;
    }
    const double value = lidar.number(result, row.fact).value_or(0.0);
    const bool is_right = value >= right.least && value <= right.most;
    if (is_right && row.only_refutes) continue;
    const bool is_yes_or_no = std::holds_alternative<std::string>(fact->value);
    result.find(is_right ? finding::agrees : finding::differs,
                is_right ? ""
                         : fmt::format("{} is {}, expected {}.{}{}", fact->name, fact->text(),
                                       words_of(right, is_yes_or_no), row.advice.empty() ? "" : " ",
                                       row.advice));
  }
  if (!not_stated.empty()) result.find(finding::observed, "Not in the table: " + not_stated + ".");
  if (result.text.empty()) result.text = "As expected.";
}

class runner {
 public:
  runner(connector& connector, const run_options& options)
      : options_(options), lidar_(connector, options) {}

  report go() {
    if (const auto opened = lidar_.open(); !opened) return {{}, opened.error()};
    try {
      for (const step_row& row : step_rows()) {
        step_result result{.of = row.of};
        take(row, result);
        if (options_.on_result) options_.on_result(result);
        lidar_.results.push_back(std::move(result));
        if (is_cancelled() || failure_) break;
      }
    } catch (...) {
      leave_as_it_was();
      throw;
    }
    leave_as_it_was();
    return {std::move(lidar_.results), failure_};
  }

 private:
  [[nodiscard]] bool is_cancelled() const {
    return options_.is_cancelled && options_.is_cancelled();
  }

  void take(const step_row& row, step_result& result) {
    if (!row.has(lidar_)) return result.find(finding::not_done, row.missing);
    if (options_.on_step) options_.on_step(row.of);
    if (row.changes != setting::none) lidar_.settings.remember(*lidar_.link, lidar_.row);
    row.measure(lidar_, result);
    // What a step did not hear because it was interrupted is no difference.
    if (is_cancelled()) {
      result = {.of = row.of};
      return result.find(finding::not_done, "Interrupted.");
    }
    if (row.of != step::unplug) failure_ = lidar_.link ? lidar_.link->failure() : lidar_.why_closed;
    if (failure_) {
      result = {.of = row.of};
      return result.find(finding::not_done, "The connection was lost.");
    }
    check(lidar_, result);
    if (!lidar_.link || !lidar_.settings.is_changed() || !lidar_.is_same()) return;
    if (!lidar_.settings.restore(*lidar_.link) && !is_cancelled())
      result.find(finding::differs, "The setting could not be set back.");
  }

  /// The end of every run, also of one that was cancelled or has lost its lidar.
  void leave_as_it_was() {
    if (lidar_.link) lidar_.link->ignore_cancel();
    if (lidar_.link && lidar_.link->is_over()) lidar_.link->stop();
    const bool is_changed = lidar_.settings.is_changed();
    if (is_changed && (!lidar_.link || lidar_.link->is_over())) {
      const auto wait = std::chrono::nanoseconds(options_.return_time).count();
      if (lidar_.reopen(wait, false)) lidar_.link->ignore_cancel();
    }
    if (lidar_.link) lidar_.link->stop();
    const bool is_back =
        lidar_.link && !lidar_.link->is_over() && (!is_changed || lidar_.is_same());
    if (is_back && lidar_.settings.restore(*lidar_.link)) return;
    if (is_changed && options_.on_lost_settings)
      options_.on_lost_settings(lidar_.settings.words(lidar_.row));
  }

  const run_options& options_;
  tested_lidar lidar_;
  std::optional<error> failure_{};
};

}  // namespace

std::string_view name_of(finding finding) noexcept {
  return findings.at(static_cast<std::size_t>(finding));
}

void step_result::find(finding finding, std::string_view sentence) {
  outcome = std::max(outcome, finding);
  if (!text.empty() && !sentence.empty()) text += ' ';
  text += sentence;
}

report run(connector& connector, const run_options& options) {
  return runner(connector, options).go();
}

}  // namespace g4_tool::acceptance
