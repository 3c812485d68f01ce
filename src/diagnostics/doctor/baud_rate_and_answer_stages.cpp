// SPDX-License-Identifier: MIT
// The stages up to health, including the diagnosis of a wrong baud rate: the device is observed,
// stopped, and queried.
#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "g4lidar/transport/recognition.hpp"
#include "link/identity_reader.hpp"
#include "live_run.hpp"
#include "transport/custom_baud.hpp"

namespace g4lidar {
namespace {

/// Two revolutions at the lowest frequency of lidars that answer nothing.
constexpr std::int64_t information_ns = 700 * ms;
/// For the first packets of a lidar that was started to see its samples.
constexpr std::int64_t samples_ns = 3'000 * ms;

/// A remark if the bridge cannot make the wanted rate, or if the lidar has not that of its model.
void add_rate_difference(stage_report& report, std::uint32_t real, std::uint32_t given,
                         const model& model) {
  constexpr std::uint64_t remarkable = 15;  // in thousandths
  if (real == 0 || !report.remark.empty()) return;
  const auto is_near = [real](std::uint32_t own) { return own != 0 && is_tolerable(real, own); };
  const auto* const own = std::ranges::find_if(model.bauds, is_near);
  if (given == 0 && own == model.bauds.end()) {
    report.remark =
        "Usually " + one_of(model) + " has " + std::to_string(model.bauds[0]) + " baud.";
    return;
  }
  const std::uint32_t wanted = given != 0 ? given : *own;
  if (!is_tolerable(real, wanted) || baud_difference(real, wanted) <= remarkable) return;
  report.remark = "The port runs at " + std::to_string(real) + " baud instead of " +
                  std::to_string(wanted) + ".";
}

/// The model, the size of its samples as far as packets have shown it (0: not), and the others that send the same bytes.
void add_model(stage_report& report, const examined_lidar& lidar, std::size_t sample_bytes) {
  report.add("model", std::string(lidar.which->word));
  if (sample_bytes != 0) report.add("bytes_per_sample", sample_bytes);
  if (lidar.candidates.size() > 1) {
    report.add("same_bytes", words_of(std::span(lidar.candidates).subspan(1)));
  }
}

/// The rate of the line; 0: behind a network bridge, where nobody has named it.
std::uint32_t known_baud(const examined_lidar& lidar, const diagnostic_options& options,
                         const transport& port) {
  return lidar.has_baud || options.baud != 0 ? port.baud() : 0;
}

}  // namespace

live_run::live_run(std::unique_ptr<transport> opened, stage_log& log, bool may_pulse_dtr)
    : log_(log),
      lidar_{.which = log.options().model != nullptr ? log.options().model : &g4_model,
             .is_named = log.options().model != nullptr},
      link_(std::move(opened), log.options().is_cancelled, *lidar_.which,
            log.options().listen_only),
      contact_({log_, link_, replies_, lidar_, answer_}, may_pulse_dtr) {
  log.come_from(link_.port().name());
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
  const double seconds = static_cast<double>(measured_ns_) / 1e9;
  report_rate(log_, measured_, device_, *lidar_.which);
  report_loss(log_, measured_, *lidar_.which, &link_.survey(), seconds);
  report_returns(log_, measured_, device_, *lidar_.which, log_.options().directions);
  report_latency(log_, measured_, baud, link_.port().name());
}

bool live_run::end() {
  link_.ignore_cancel();
  const bool is_stopped = !talks() || !lidar_.takes_commands() || link_.stop();
  const bool sets_dtr = lidar_.is_driven_by_dtr() && !log_.options().listen_only;
  if (sets_dtr) static_cast<void>(link_.port().set_dtr(false));
  return is_stopped;
}

void live_run::add_failure(stage_report& report) {
  const std::optional<error>& why = link_.failure();
  if (!why) return;
  report.find(diagnosis_of(why->code()));
  report.detail = why->detail();
  report.remark = cause_of(*why);
}

bool live_run::find_device() {
  stage_report baud{.stage = diagnostic_stage::baud_rate};
  const bool is_mute = log_.options().listen_only;
  const std::uint32_t expected_baud = known_baud(lidar_, log_.options(), link_.port());
  const first_contact::state found = contact_.make(baud);
  const bool goes_on = found == first_contact::state::made;
  // Without a packet or an answer at this rate it is only what the port was set to.
  const bool is_rate =
      goes_on || (found == first_contact::state::refused && !baud.measurements.empty());
  const std::uint32_t baud_now = known_baud(lidar_, log_.options(), link_.port());
  const bool is_wrong =
      std::ranges::find(baud.diagnoses, diagnosis::wrong_baud_rate) != baud.diagnoses.end();
  if (is_rate && baud_now != 0) {
    baud.measurements.insert(baud.measurements.begin(),
                             make_evidence("baud", is_wrong ? expected_baud : baud_now));
  }
  if (goes_on) {
    contact_.report_scanning();
    const auto who = replies_.snapshot(*lidar_.which).information;
    const auto has_number = [&](const model& row) { return row.has_number(who->model); };
    const bool is_unknown = who && !lidar_.was_scanning && std::ranges::none_of(models, has_number);
    if (lidar_.is_named || (!is_unknown && (who || !lidar_.candidates.empty()))) {
      add_model(baud, lidar_, link_.sample_bytes());
    }
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
    if (is_mute) {
      answer_.remark = "Nothing was sent: a lidar that waits for a command is silent.";
    } else if (!lidar_.is_named) {
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
  if (!talks()) {
    const std::string name(lidar_.which->name);
    log_.skip(diagnostic_stage::answers,
              lidar_.is_one_way() ? "It does not apply: a model like " + name + " answers nothing."
                                  : "Nothing was sent: the lidar was only listened to.");
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
    if (replies_.has_mute_question(*lidar_.which) && talks() && !lidar_.is_deaf) {
      see_samples();
      link_.stop();
      if (is_of_other_size()) replies_.may_know_less();
    }
    if (!replies_.exchanges().empty()) {
      replies_.judge(answer_, link_.host_pauses() > 0, *lidar_.which);
    }
    const bool is_silent =
        std::ranges::find(answer_.diagnoses, diagnosis::stalls) != answer_.diagnoses.end();
    if (is_silent) answer_.add("silence_ms", (link_.now_ns() - link_.heard_ns()) / ms);
    if (link_.boots() > 0) answer_.add("boots", link_.boots());
    if (link_.boots() > 1) answer_.find(diagnosis::reboots);
    if (lidar_.is_deaf && answer_.remark.empty()) {
      answer_.remark = contradictions_of({.model = lidar_.which, .is_silent = true});
    }
    add_failure(answer_);
    log_.report(std::move(answer_));
    device_ = replies_.snapshot(*lidar_.which);
  }
  if (link_.is_over()) return false;
  const std::uint32_t its_baud = known_baud(lidar_, log_.options(), link_.port());
  if (device_.information && lidar_.is_named && link_.sample_bytes() == 0 && talks() &&
      refuses_number(log_.options(), *lidar_.which, device_.information->model, its_baud)) {
    see_samples();
  }
  return report_identity(log_, device_.information, *lidar_.which, its_baud,
                         link_.sample_bytes()) &&
         report_health(log_, device_.condition);
}

// Its packets show whether it is the model as which it was asked, or could be read as the named one.
void live_run::see_samples() {
  start_scan();
  const std::int64_t until_ns = link_.now_ns() + samples_ns;
  const auto is_certain = [this] {
    const std::size_t size = link_.survey().layout().sample_bytes();
    return size != 0 && link_.survey().layout().votes(size) >= certain_packets;
  };
  while (!link_.is_over() && link_.now_ns() < until_ns && !is_certain()) link_.listen_for(50 * ms);
}

void live_run::read_information() {
  if (lidar_.which->ct_information == presence::no) return;
  const std::int64_t until_ns = link_.now_ns() + information_ns;
  while (!link_.is_over() && link_.now_ns() < until_ns && !link_.survey().layout().information()) {
    link_.listen_for(50 * ms);
  }
  const auto stated = link_.survey().layout().information();
  if (!stated) return;
  if (const auto who = information_of(*stated, *lidar_.which); who.is_known()) {
    device_.information = who;
  }
  if (stated->has_faults) device_.condition = health_of(*stated);
}

}  // namespace g4lidar
