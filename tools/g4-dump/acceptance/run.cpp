// SPDX-License-Identifier: MIT
// The one runner of all steps.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "rows.hpp"

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
void check(const subject& of, step_result& into) {
  std::string not_stated;
  for (const check_row& row : check_rows()) {
    const auto fact = std::ranges::find(into.facts, row.fact, &evidence::name);
    if (row.of != into.of || fact == into.facts.end()) continue;
    const expected right = row.by_table({of, into});
    if (!right.is_known) {
      not_stated +=
          fmt::format("{}{} {}", not_stated.empty() ? "" : ", ", fact->name, fact->text());
      continue;
    }
    const double value = of.number(into, row.fact).value_or(0.0);
    const bool is_right = value >= right.least && value <= right.most;
    if (is_right && row.only_refutes) continue;
    const bool is_yes_or_no = std::holds_alternative<std::string>(fact->value);
    into.find(is_right ? finding::agrees : finding::differs,
              is_right ? ""
                       : fmt::format("{} is {}, expected {}.{}{}", fact->name, fact->text(),
                                     words_of(right, is_yes_or_no), row.advice.empty() ? "" : " ",
                                     row.advice));
  }
  if (!not_stated.empty()) into.find(finding::observed, "Not in the table: " + not_stated + ".");
  if (into.text.empty()) into.text = "As expected.";
}

class runner {
 public:
  runner(connector& from, const run_options& options) : options_(options), of_(from, options) {}

  report go() {
    if (const auto opened = of_.open(); !opened) return {{}, opened.error()};
    try {
      for (const step_row& row : step_rows()) {
        step_result into{.of = row.of};
        take(row, into);
        if (options_.on_result) options_.on_result(into);
        of_.results.push_back(std::move(into));
        if (is_cancelled() || failure_) break;
      }
    } catch (...) {
      leave_as_it_was();
      throw;
    }
    leave_as_it_was();
    return {std::move(of_.results), failure_};
  }

 private:
  [[nodiscard]] bool is_cancelled() const {
    return options_.is_cancelled && options_.is_cancelled();
  }

  void take(const step_row& row, step_result& into) {
    if (!row.has(of_)) return into.find(finding::not_done, row.missing);
    if (options_.on_step) options_.on_step(row.of);
    if (row.changes != setting::none) of_.settings.remember(*of_.link, of_.row);
    row.measure(of_, into);
    // What a step did not hear because it was interrupted is no difference.
    if (is_cancelled()) {
      into = {.of = row.of};
      return into.find(finding::not_done, "Interrupted.");
    }
    if (row.of != step::unplug) failure_ = of_.link ? of_.link->failure() : of_.why_closed;
    if (failure_) {
      into = {.of = row.of};
      return into.find(finding::not_done, "The connection was lost.");
    }
    check(of_, into);
    if (!of_.link || !of_.settings.is_changed() || !of_.is_same()) return;
    if (!of_.settings.restore(*of_.link) && !is_cancelled())
      into.find(finding::differs, "The setting could not be set back.");
  }

  /// The end of every run, also of one that was cancelled or has lost its lidar.
  void leave_as_it_was() {
    if (of_.link) of_.link->ignore_cancel();
    if (of_.link && of_.link->is_over()) of_.link->stop();
    const bool is_changed = of_.settings.is_changed();
    if (is_changed && (!of_.link || of_.link->is_over())) {
      const auto wait = std::chrono::nanoseconds(options_.return_time).count();
      if (of_.reopen(wait, false)) of_.link->ignore_cancel();
    }
    if (of_.link) of_.link->stop();
    const bool is_back = of_.link && !of_.link->is_over() && (!is_changed || of_.is_same());
    if (is_back && of_.settings.restore(*of_.link)) return;
    if (is_changed && options_.on_lost_settings)
      options_.on_lost_settings(of_.settings.words(of_.row));
  }

  const run_options& options_;
  subject of_;
  std::optional<error> failure_{};
};

}  // namespace

std::string_view name_of(finding how) noexcept {
  return findings.at(static_cast<std::size_t>(how));
}

void step_result::find(finding how, std::string_view sentence) {
  outcome = std::max(outcome, how);
  if (!text.empty() && !sentence.empty()) text += ' ';
  text += sentence;
}

report run(connector& from, const run_options& options) { return runner(from, options).go(); }

}  // namespace g4_tool::acceptance
