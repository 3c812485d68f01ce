// SPDX-License-Identifier: MIT
// The stages up to health, including the diagnosis of a wrong baud rate: the device is observed,
// stopped, and queried.
#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "driver/identity_reader.hpp"
#include "live_run.hpp"
#include "transport/custom_baud.hpp"

namespace g4lidar {
namespace {

/// Two revolutions at the lowest frequency of lidars that answer nothing.
constexpr std::int64_t information_ns = 700 * ms;

/// A remark if the bridge cannot make the wanted rate, or if the lidar has not that of its model.
void add_rate_difference(stage_report& report, std::uint32_t real, std::uint32_t given,
                         const model& which) {
  constexpr std::uint64_t remarkable = 15;  // in thousandths
  if (real == 0 || !report.remark.empty()) return;
  const auto is_near = [real](std::uint32_t own) { return own != 0 && is_tolerable(real, own); };
  const auto* const own = std::ranges::find_if(which.bauds, is_near);
  if (given == 0 && own == which.bauds.end()) {
    report.remark =
        "Usually " + one_of(which) + " has " + std::to_string(which.bauds[0]) + " baud.";
    return;
  }
  const std::uint32_t wanted = given != 0 ? given : *own;
  if (!is_tolerable(real, wanted) || baud_difference(real, wanted) <= remarkable) return;
  report.remark = "The port runs at " + std::to_string(real) + " baud instead of " +
                  std::to_string(wanted) + ".";
}

/// The model, and the others that send the same bytes.
void add_model(stage_report& report, const examined_lidar& lidar) {
  report.add("model", std::string(lidar.which->word));
  report.add("bytes_per_sample", sample_size(lidar.which->samples.layout));
  if (lidar.candidates.size() > 1) {
    report.add("same_bytes", words_of(std::span(lidar.candidates).subspan(1)));
  }
}

}  // namespace

live_run::live_run(std::unique_ptr<transport> opened, stage_log& log, bool may_pulse_dtr)
    : log_(log),
      lidar_{.which = log.options().model != nullptr ? log.options().model : &g4_model,
             .is_named = log.options().model != nullptr},
      link_(std::move(opened), log.options().is_cancelled, *lidar_.which),
      contact_({log_, link_, replies_, lidar_, answer_}, may_pulse_dtr) {
  const std::uint32_t baud = first_baud(log.options(), link_.port().baud());
  lidar_.has_baud = baud != 0 && link_.set_baud(baud);
}

void live_run::run() {
  if (!find_device() || !interview() || !start_motor()) {
    end();
    const auto& done = log_.stages();
    const auto last = done.empty() ? diagnostic_stage::holder : done.back().stage;
    return log_.skip_from(static_cast<diagnostic_stage>(static_cast<int>(last) + 1),
                          "Not reached.");
  }
  measure_scan();
  const bool is_over = link_.is_over();
  const std::uint32_t baud = link_.port().baud();
  const bool stopped = end() || is_over;
  if (!stopped && !lidar_.is_deaf && !measured_.has_become_garbage()) {
    stream_.find(diagnosis::deaf);
  }
  report_stream();
  report_rate(log_, measured_, device_, *lidar_.which);
  report_loss(log_, measured_, *lidar_.which, &link_.survey(),
              link_.port().name().starts_with("tcp:"));
  report_returns(log_, measured_, device_, *lidar_.which, log_.options().directions);
  report_latency(log_, measured_, baud, link_.port().name());
}

bool live_run::end() {
  link_.ignore_cancel();
  const bool is_stopped = lidar_.is_one_way() || !lidar_.takes_commands() || link_.stop();
  if (lidar_.is_driven_by_dtr()) static_cast<void>(link_.port().set_dtr(false));
  return is_stopped;
}

void live_run::add_failure(stage_report& report) {
  const std::optional<error>& why = link_.failure();
  if (!why) return;
  report.find(diagnosis_of(why->code()));
  report.remark = why->message();
}

bool live_run::find_device() {
  stage_report baud{.stage = diagnostic_stage::baud_rate};
  const first_contact::state found = contact_.make(baud);
  const bool goes_on = found == first_contact::state::made;
  // Without a packet or an answer at this rate it is only what the port was set to.
  const bool is_rate =
      goes_on || (found == first_contact::state::refused && !baud.measurements.empty());
  if (is_rate && link_.port().baud() != 0) {
    baud.measurements.insert(baud.measurements.begin(), make_evidence("baud", link_.port().baud()));
  }
  if (goes_on) {
    contact_.report_scanning();
    const bool has_number = replies_.snapshot(*lidar_.which).information.has_value();
    if (has_number || lidar_.is_named || !lidar_.candidates.empty()) add_model(baud, lidar_);
    if (lidar_.has_baud) {
      add_rate_difference(baud, link_.port().baud(), log_.options().baud, *lidar_.which);
    }
  }
  add_failure(baud);
  const bool is_silent = found == first_contact::state::none && baud.diagnoses.empty() &&
                         (!link_.is_over() || link_.failure());
  if (is_silent) {
    baud.outcome = stage_verdict::skipped;
    baud.remark = "Nothing arrived to judge it by.";
    answer_.find(diagnosis::silent);
    if (!lidar_.is_named) {
      answer_.remark =
          "No model was named: only the question for the device information was sent. If the model "
          "is named, a start is tried, too.";
    }
  }
  log_.report(std::move(baud));
  if (!goes_on && !answer_.diagnoses.empty()) log_.report(std::move(answer_));
  return goes_on && !link_.is_over();
}

bool live_run::interview() {
  if (lidar_.is_one_way()) {
    const std::string name(lidar_.which->name);
    log_.skip(diagnostic_stage::answers,
              "It does not apply: a model like " + name + " answers nothing.");
    read_information();
    if (link_.failure()) {
      stage_report identity{.stage = diagnostic_stage::identity};
      add_failure(identity);
      log_.report(std::move(identity));
    }
  } else {
    const auto is_disturbed = [&] {
      return !replies_.exchanges().empty() && replies_.exchanges().back().packets > 0;
    };
    for (int i = 0; i < 2 && !link_.is_over() && !lidar_.is_deaf && is_disturbed(); ++i) {
      lidar_.was_scanning = true;
      if (contact_.make_quiet()) ask_all(link_, replies_, *lidar_.which, 0);
      contact_.report_scanning();
    }
    if (!replies_.exchanges().empty()) {
      replies_.judge(answer_, link_.host_pauses() > 0, *lidar_.which);
    }
    if (link_.boots() > 0) answer_.add("boots", link_.boots());
    if (link_.boots() > 1) answer_.find(diagnosis::reboots);
    add_failure(answer_);
    log_.report(std::move(answer_));
    device_ = replies_.snapshot(*lidar_.which);
  }
  if (link_.is_over()) return false;
  return report_identity(log_, device_.information, *lidar_.which, link_.port().baud()) &&
         report_health(log_, device_.condition);
}

void live_run::read_information() {
  if (lidar_.which->ct_information == presence::no) return;
  const std::int64_t until_ns = link_.now_ns() + information_ns;
  while (!link_.is_over() && link_.now_ns() < until_ns && !link_.layout().information()) {
    link_.listen_for(50 * ms);
  }
  const auto stated = link_.layout().information();
  if (!stated) return;
  if (const auto who = information_of(*stated, *lidar_.which); who.is_known()) {
    device_.information = who;
  }
  if (stated->has_faults) device_.condition = health_of(*stated);
}

}  // namespace g4lidar
