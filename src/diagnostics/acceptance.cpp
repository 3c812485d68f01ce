// SPDX-License-Identifier: MIT
// The names of the steps, the open questions, and the way through the steps.
#include "g4lidar/diagnostics/acceptance.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "acceptance_run.hpp"
#include "stages.hpp"

namespace g4lidar {
namespace {

using enum acceptance_step;

constexpr std::array questions{
    open_question{"Which USB bridge is used, and which baud rate does it really set?", bridge},
    open_question{"Which models send before they are asked, and what?", listening},
    open_question{"With which number does the device identify itself?", identity},
    open_question{"Does a one-way lidar answer any query?", queries},
    open_question{"Are the rate (D1), the direction (08) and low power (05) answered?", queries},
    open_question{"What does the offset of zero (93) contain?", queries},
    open_question{"Which error codes does the health contain?", queries},
    open_question{"Is there power-down protection (D9)?", protection},
    open_question{"What is answered at the limits of the scan frequency?", frequency},
    open_question{"Which sample rate is behind each code?", sample_rate},
    open_question{"How long are the packets at each sample rate?", sample_rate},
    open_question{"Does the command 00 alone stop the scan?", start_and_stop},
    open_question{"How long does the motor spin up?", start_and_stop},
    open_question{"Does an edge of DTR start the motor, or its level?", dtr},
    open_question{"Does DTR switch the motor, or the supply of the whole lidar?", dtr},
    open_question{"Do zero packets report the frequency, and with which offset?", stream},
    open_question{"Do all packets have the layout of the table?", stream},
    open_question{"Are the two lower bits of a sample flags, intensity or range?", sample_bits},
    open_question{"Do the CT bytes contain information, and does a CRC byte follow?",
                  acceptance_step::ct_information},
    open_question{"Are there time packets?", acceptance_step::time_packets},
    open_question{"Where is zero, and is the offset of 93 already applied?", near_target},
    open_question{"Is the unit of the range that of the table?", far_target},
    open_question{"Do the settings outlive a loss of power?", unplug},
};

constexpr std::array<std::string_view, acceptance_step_count> step_names{
    "bridge",       "listening",      "identity",   "queries", "protection",  "frequency",
    "sample_rate",  "start_and_stop", "dtr",        "stream",  "sample_bits", "ct_information",
    "time_packets", "near_target",    "far_target", "unplug"};
constexpr std::array<std::string_view, 4> verdict_names{"agrees", "observed", "not_done",
                                                        "differs"};

}  // namespace

std::span<const open_question> open_questions() noexcept { return questions; }

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
    std::string why_not;
    if (!is_open || !link_ || link_->monitor().is_over()) {
      const bool is_cancelled = link_ && link_->monitor().is_cancelled();
      std::string why = why_closed_.empty() ? "Not reached." : why_closed_;
      if (link_ && link_->monitor().failure()) why = link_->monitor().failure()->message();
      into.add_finding(acceptance_verdict::not_done, is_cancelled ? "Interrupted." : why);
    } else if (!is_possible(step, why_not)) {
      into.add_finding(acceptance_verdict::not_done, why_not);
    } else {
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
  if (options_.model == nullptr && !recognise(**opened)) return false;
  const auto rate = (*opened)->set_baud(baud());
  if (!rate) {
    why_closed_ = rate.error().message();
    return false;
  }
  link_.emplace(*std::move(opened), options_.is_cancelled, *which_);
  return true;
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

bool acceptance_run::is_possible(acceptance_step step, std::string& why_not) const {
  const auto needs = [&why_not](bool has, std::string_view why) {
    if (!has) why_not = why;
    return has;
  };
  switch (step) {
    case acceptance_step::protection:
      return needs(is_two_way() && which_->protection != presence::no,
                   "The model does not have it.");
    case acceptance_step::frequency:
      return needs(which_->frequency.max_dhz != 0, "The model has no command for it.");
    case acceptance_step::sample_rate:
      return needs(which_->rates.is_settable,
                   "The model has one sample rate, or no command for it.");
    case acceptance_step::start_and_stop:
      return needs(is_two_way(), "The model takes no commands.");
    case acceptance_step::sample_bits:
    case acceptance_step::ct_information:
    case acceptance_step::time_packets:
      return needs(surveyed_ && surveyed_->packets() > 0, "There were no packets.");
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
