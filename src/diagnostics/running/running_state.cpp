// SPDX-License-Identifier: MIT
#include "running_state.hpp"

#include <utility>

#include "g4lidar/detail/saturating.hpp"

namespace g4lidar {
namespace {

/// Shorter windows give no rate.
constexpr double shortest_rate_s = 1.0;

/// The diagnosis of an error of the driver; nothing if the caller has made a mistake, or may go on.
std::optional<diagnosis> diagnosis_of(const error& why) {
  switch (why.code()) {
    case problem::bad_option:
    case problem::bad_setting:
    case problem::not_scanning:
      return std::nullopt;
    case problem::timeout:
    case problem::not_reached:
    case problem::wrong_answer:
    case problem::silence:
      if (why.doing() == task::starting) return diagnosis::does_not_start;
      [[fallthrough]];
    default:
      if (!why.is_fatal()) return std::nullopt;
      return g4lidar::diagnosis_of(why.code());
  }
}

}  // namespace

/// Adds the diagnoses of this stage.
void running_state::copy::add_to(stage_report& report) const {
  if (report.detail == error_detail::usual) report.detail = lost_case;
  for (const diagnosis what : found) {
    if (stage_of(what) != report.stage) continue;
    report.find(what);
    if (what == diagnosis::stalls && stall_ns > 0) report.add("silence_ms", stall_ns / ms);
  }
}

void running_state::add(const lidar_event& what) {
  using enum lidar_event::kind;
  const std::lock_guard hold(mutex_);
  switch (what.what) {
    case lost:
      if (is_device_ || what.reason != problem::end_of_input) {
        lost_ = g4lidar::diagnosis_of(what.reason);
        if (lost_ == diagnosis::stalls) stall_ns_ = 0;  // this one
      }
      break;
    case reconnected:
      ++reconnects_;
      back();
      break;
    case found_scanning:
      found_.add(diagnosis::was_scanning, now_ns_);
      break;
    case protection_starved:
      found_.add(diagnosis::host_busy, now_ns_);
      break;
    case protection_found_on:
      found_.add(diagnosis::protection_on, now_ns_);
      break;
    case restarted:
      is_restarted_ = true;
      break;
    case health_warning:
      found_.add(diagnosis::health_warning, now_ns_);
      break;
    case no_zero_angle:
      found_.add(diagnosis::no_zero_angle, now_ns_);
      break;
    case other_number:
      found_.add(diagnosis::other_number, now_ns_);
      break;
    case spinning_up:
    case other_lidar:
    case long_pause:
    case overflow:
    case still_turning:
      break;
  }
}
void running_state::add(const error& why) {
  const std::lock_guard hold(mutex_);
  if (!is_device_ && why == problem::end_of_input) return;
  const auto found = diagnosis_of(why);
  if (!found) return;
  lost_ = found;
  why_lost_ = cause_of(why);
  lost_case_ = why.detail();
}

running_state::copy running_state::take_copy() const {
  const std::lock_guard hold(mutex_);
  copy made{scan_.now(),
            scan_.window(),
            scan_.known(),
            &scan_.which(),
            found_.since(detail::saturating_sub(now_ns_, window_ns_)),
            scan_.seconds(),
            baud_,
            {},
            name_,
            is_device_,
            lost_case_,
            lost_ == diagnosis::stalls ? std::max(stall_ns_, silence_ns()) : stall_ns_};
  if (lost_ && !found_.has(*lost_, detail::saturating_sub(now_ns_, window_ns_)))
    made.found.push_back(*lost_);
  if (!name_.empty()) made.port.add("address", name_);
  if (reconnects_ > 0) made.port.add("reconnects", reconnects_);
  made.port.remark = why_lost_;
  return made;
}

std::vector<stage_report> running_state::stages(const point_filter& directions) const {
  copy of = take_copy();
  const diagnostic_options none;
  stage_log log(none);
  log.come_from(of.name);
  if (!of.is_device) log.come_by(byte_path::file);
  const bool is_explained =
      std::ranges::any_of(of.found,
                          [](diagnosis what) {
                            const diagnostic_stage where = stage_of(what);
                            return what != diagnosis::stalls && (where == diagnostic_stage::motor ||
                                                                 where == diagnostic_stage::stream);
                          }) ||
      of.measured.tally().arrivals.longest_host_pause_ns() >= arrival_statistics::stall_ns;
  if (is_explained) std::erase(of.found, diagnosis::stalls);
  const auto add_found = [&] { of.add_to(log.stages().back()); };
  log.report(std::move(of.port));
  add_found();
  for (const auto where :
       {diagnostic_stage::permission, diagnostic_stage::holder, diagnostic_stage::baud_rate,
        diagnostic_stage::answers, diagnostic_stage::identity}) {
    stage_report report{.stage = where};
    of.add_to(report);
    if (!report.diagnoses.empty()) log.report(std::move(report));
  }
  static_cast<void>(report_health(log, of.known.condition));
  add_found();
  const bool runs = of.phase == running_scan::phase::runs;
  stage_report motor{.stage = diagnostic_stage::motor};
  stage_report stream{.stage = diagnostic_stage::stream};
  if (runs) {
    judge_motor(motor, of.measured);
    log.report(std::move(motor));
    add_found();
    of.add_to(stream);
    judge_stream(stream, of.measured, of.seconds);
    log.report(std::move(stream));
    if (of.seconds < shortest_rate_s) {
      log.skip(diagnostic_stage::rate, "The scan has not run for long enough.");
    } else {
      report_rate(log, of.measured, of.known, *of.which);
    }
    report_loss(log, of.measured, *of.which, nullptr, of.seconds);
    report_returns(log, of.measured, of.known, *of.which, directions);
    report_latency(log, of.measured, of.baud, of.name);
    return std::move(log.stages());
  }
  const char* const why =
      of.phase == running_scan::phase::rests ? "No scan is running." : "The head is speeding up.";
  for (const auto where :
       {diagnostic_stage::motor, diagnostic_stage::stream, diagnostic_stage::rate,
        diagnostic_stage::loss, diagnostic_stage::returns, diagnostic_stage::usb_latency}) {
    log.skip(where, why);
    add_found();
  }
  return std::move(log.stages());
}

}  // namespace g4lidar
