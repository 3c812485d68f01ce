// SPDX-License-Identifier: MIT
// The names of the steps, and the way through the steps.
#include "g4lidar/diagnostics/acceptance.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <utility>

#include "acceptance_run.hpp"
#include "stages.hpp"

namespace g4lidar {
namespace {

constexpr std::array<std::string_view, acceptance_step_count> step_names{
    "bridge",       "listening",      "identity",   "queries", "protection",  "frequency",
    "sample_rate",  "start_and_stop", "dtr",        "stream",  "sample_bits", "ct_information",
    "time_packets", "near_target",    "far_target", "unplug"};
constexpr std::array<std::string_view, 4> verdict_names{"agrees", "observed", "not_done",
                                                        "differs"};

}  // namespace

std::string_view name_of(acceptance_step step) noexcept {
  return step_names.at(static_cast<std::size_t>(step));
}

std::string_view name_of(acceptance_verdict how) noexcept {
  return verdict_names.at(static_cast<std::size_t>(how));
}

void acceptance_result::add_finding(acceptance_verdict how, std::string_view sentence) {
  outcome = std::max(outcome, how);
  if (!text.empty()) text += ' ';
  text += sentence;
}

std::vector<acceptance_result> run_acceptance(connector& from, const acceptance_options& options) {
  return acceptance_run(from, options).run();
}

std::vector<acceptance_result> acceptance_run::run() {
  const bool is_open = open();
  for (std::size_t i = 0; i < acceptance_step_count; ++i) {
    const auto step = static_cast<acceptance_step>(i);
    acceptance_result into{.step = step};
    if (!is_open || !link_ || link_->monitor().is_over()) {
      const bool is_cancelled = link_ && link_->monitor().is_cancelled();
      std::string why = why_closed_.empty() ? "Not reached." : why_closed_;
      const auto failure = link_ ? link_->monitor().failure() : std::nullopt;
      if (failure) why = failure->message();
      into.add_finding(acceptance_verdict::not_done, is_cancelled ? "Interrupted." : why);
    } else if (is_possible(into)) {
      if (options_.on_step) options_.on_step(step);
      take(into);
    }
    if (options_.on_result) options_.on_result(into);
    results_.push_back(std::move(into));
  }
  if (link_) {
    link_->monitor().ignore_cancel();
    link_->stop();
  }
  return std::move(results_);
}

bool acceptance_run::open() {
  auto opened = from_.connect();
  if (!opened) {
    why_closed_ = opened.error().message();
    return false;
  }
  const bool is_searched = options_.model == nullptr && found_baud_ == 0;
  if (is_searched && !recognise(**opened)) return false;
  const auto rate = (*opened)->set_baud(baud());
  if (!rate) {
    why_closed_ = rate.error().message();
    return false;
  }
  link_ = std::make_unique<acceptance_link>(*std::move(opened), options_.is_cancelled, *which_);
  return true;
}

bool acceptance_run::reopen(std::int64_t wait_ns) {
  constexpr std::int64_t retry_ns = 200 * ms;
  link_.reset();
  const std::int64_t until_ns = from_.now_ns() + wait_ns;
  do {
    static_cast<void>(from_.pause(from_.now_ns() + retry_ns));
    if (options_.is_cancelled && options_.is_cancelled()) return false;
    if (open()) return true;
  } while (from_.now_ns() < until_ns);
  return false;
}

bool acceptance_run::recognise(transport& port) {
  constexpr std::int64_t search_ns = 3'000 * ms;
  const auto found =
      search(port, port.now_ns() + search_ns, {.baud = options_.baud, .may_pulse_dtr = true});
  if (!found) {
    why_closed_ = found.error().message();
    return false;
  }
  if (found->candidates.size() > 1) {
    why_closed_ =
        "The bytes are those of several models: name one of " + words_of(found->candidates) + ".";
    return false;
  }
  which_ = found->model;
  found_baud_ = found->baud;
  return true;
}

/// Whether the step can be done; else `into` has the reason.
bool acceptance_run::is_possible(acceptance_result& into) const {
  const auto needs = [&into](bool has, std::string_view why) {
    if (!has) into.add_finding(acceptance_verdict::not_done, why);
    return has;
  };
  // What the model does not have: its questions do not arise.
  const auto model_needs = [&](bool has, std::string_view why) {
    for (const open_question& each : open_questions()) {
      if (!has && each.step == into.step) {
        into.add_answer(each.which, answer_state::not_applicable, why);
      }
    }
    return needs(has, why);
  };
  switch (into.step) {
    case acceptance_step::protection:
      return model_needs(is_two_way() && which_->protection != presence::no,
                         "The model does not have it.");
    case acceptance_step::frequency:
      return model_needs(which_->frequency.max_dhz != 0, "The model has no command for it.");
    case acceptance_step::sample_rate:
      return model_needs(which_->rates.is_settable,
                         "The model has one sample rate, or no command for it.");
    case acceptance_step::start_and_stop:
      if (!is_two_way()) {
        into.add_answer(acceptance_question::forced_stop, answer_state::not_applicable,
                        "The model takes no commands.");
      }
      return needs(is_two_way(), "The model takes no commands.");
    case acceptance_step::sample_bits:
    case acceptance_step::ct_information:
    case acceptance_step::time_packets:
      return needs(surveyed_ && surveyed_->counts().packets > 0, "There were no packets.");
    case acceptance_step::far_target:
      return needs(target_degree_.has_value(), "There was no near target.");
    default:
      return true;
  }
}

void acceptance_run::take(acceptance_result& into) {
  switch (into.step) {
    case acceptance_step::bridge:
      return bridge(into);
    case acceptance_step::listening:
      return listening(into);
    case acceptance_step::identity:
      return identity(into);
    case acceptance_step::queries:
      return queries(into);
    case acceptance_step::protection:
      return protection(into);
    case acceptance_step::frequency:
      return frequency(into);
    case acceptance_step::sample_rate:
      return sample_rate(into);
    case acceptance_step::start_and_stop:
      return start_and_stop(into);
    case acceptance_step::dtr:
      return dtr(into);
    case acceptance_step::stream:
      return stream(into);
    case acceptance_step::sample_bits:
      return sample_bits(into);
    case acceptance_step::ct_information:
      return ct_information(into);
    case acceptance_step::time_packets:
      return time_packets(into);
    case acceptance_step::near_target:
      return target(into, acceptance_action::place_near);
    case acceptance_step::far_target:
      return target(into, acceptance_action::place_far);
    case acceptance_step::unplug:
      return unplug(into);
  }
}

}  // namespace g4lidar
