// SPDX-License-Identifier: MIT
// The stages up to health, including the diagnosis of a wrong baud rate: the device is observed,
// stopped, and queried.
#include "live_run.hpp"

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "transport/custom_baud.hpp"

namespace g4lidar {
namespace {

/// The time of observation before anything is sent.
constexpr std::int64_t unasked_ns = 300 * ms;
/// The wait for the first reply, for each attempt: a device may be booting, and a reply may be
/// late.
constexpr std::array<std::int64_t, 3> first_patience_ns{800 * ms, 800 * ms, 3'000 * ms};
/// The number of further attempts if the bytes contained no packets or responses: they may have been noise.
constexpr std::size_t more_times = 5;
constexpr std::int64_t more_patience_ns = 300 * ms;
constexpr std::array<std::uint32_t, 5> other_rates{115200, 512000, 128000, 153600, 256000};

/// A remark if the bridge cannot make the wanted rate.
void add_rate_difference(stage_report& report, std::uint32_t real, std::uint32_t wanted) {
  constexpr std::uint64_t remarkable = 15;  // in thousandths
  if (wanted == 0 || !is_tolerable(real, wanted) || !report.remark.empty()) return;
  if (baud_difference(real, wanted) <= remarkable) return;
  report.remark = "The port runs at " + std::to_string(real) + " baud instead of " +
                  std::to_string(wanted) + ".";
}

}  // namespace

live_run::live_run(std::unique_ptr<transport> opened, stage_log& log)
    : log_(log), link_(std::move(opened), log.options().is_cancelled), baud_(link_.baud()) {}

void live_run::run() {
  if (!find_device() || !interview() || !start_motor()) {
    link_.ignore_cancel();
    link_.stop();
    link_.stop_after_failure();
    const auto& done = log_.stages();
    const auto last = done.empty() ? diagnostic_stage::holder : done.back().stage;
    return log_.skip_from(static_cast<diagnostic_stage>(static_cast<int>(last) + 1),
                          "Not reached.");
  }
  measure_scan();
  link_.ignore_cancel();
  const bool stopped = link_.is_over() || link_.stop();
  link_.stop_after_failure();
  if (!stopped && !is_deaf_ && !measured_.has_become_garbage()) stream_.find(diagnosis::deaf);
  report_stream();
  report_rate(log_, measured_, device_);
  report_loss(log_, measured_);
  report_latency(log_, measured_, baud_, link_.name());
}

void live_run::add_failure(stage_report& report) {
  const std::optional<error>& why = link_.failure();
  if (!why) return;
  report.find(diagnosis_of(why->code()));
  report.remark = why->message();
}

bool live_run::find_device() {
  stage_report baud{.stage = diagnostic_stage::baud_rate};
  if (baud_ != 0) baud.add("baud", baud_);
  const bool is_met = (make_quiet() && first_contact()) || link_.counts().packets > 0;
  bool goes_on = is_met;
  if (!is_met && !link_.is_over()) {
    if (garbage_ == 0 && scans_when_started()) {
      answer_.find(diagnosis::answers_missing);
      goes_on = true;
    } else {
      look_for_baud_rate(baud);
    }
  }
  add_failure(baud);
  add_rate_difference(baud, baud_, log_.options().baud);
  const bool is_silent = !goes_on && baud.diagnoses.empty() && !link_.is_cancelled();
  if (is_silent) {
    baud.outcome = stage_verdict::skipped;
    baud.remark = "Nothing arrived to judge it by.";
  }
  log_.report(std::move(baud));
  if (is_silent) {
    answer_.find(diagnosis::silent);
    log_.report(std::move(answer_));
  }
  return goes_on && !link_.is_over();
}

bool live_run::make_quiet() {
  log_.begin(diagnostic_activity::listening);
  const stream_counts before = link_.counts();
  link_.listen_for(unasked_ns);
  const std::uint64_t unasked = link_.counts().packets;
  const bool is_quiet = !link_.is_over() && link_.stop();
  const stream_counts& now = link_.counts();
  if (now.packets > before.packets) answer_.find(diagnosis::was_scanning);
  if (now.packets == 0 && link_.boots() == 0) {
    garbage_ += now.skipped_bytes() - before.skipped_bytes();
  }
  if (is_quiet || link_.is_over()) return is_quiet;
  is_deaf_ = now.packets > unasked;
  if (is_deaf_) answer_.find(diagnosis::deaf);
  return false;
}

bool live_run::first_contact() {
  log_.begin(diagnostic_activity::asking);
  std::int64_t begin_ns = -1;
  const std::size_t times = first_patience_ns.size();
  for (std::size_t i = 0; i < times + (garbage_ > 0 ? more_times : 0) && !link_.is_over(); ++i) {
    const std::int64_t patience_ns = i < times ? first_patience_ns.at(i) : more_patience_ns;
    exchange made = link_.ask(command::device_info, patience_ns);
    if (begin_ns < 0) begin_ns = made.asked_ns;
    if (made.is_answered() || made.wrong > 0) {
      ask_the_rest(std::move(made), begin_ns);
      return true;
    }
    if (made.packets > 0) {
      if (!make_quiet()) return false;
      begin_ns = -1;
      continue;
    }
    if (!made.is_disturbed) garbage_ += made.skipped;
  }
  return false;
}

// If the query was repeated, the device was booting; or the replies are late, and others will
// follow.
void live_run::ask_the_rest(exchange last, std::int64_t begin_ns) {
  const bool booted = link_.boots() > 0;
  const std::int64_t longest_ns = last.is_answered() ? last.answered_ns - begin_ns : 0;
  bool is_late = false;
  if (begin_ns != last.asked_ns) {
    answer_.add("first_answer_after_ms", longest_ns / ms);
    const std::uint64_t before = link_.counts().responses;
    link_.listen_for_quiet(longest_ns + 100 * ms, link_.now_ns() + 10'000 * ms);
    is_late = (link_.counts().responses > before || last.copies > 0) && !booted;
  }
  if (is_late) last.asked_ns = begin_ns;
  const std::int64_t latency_ns = last.is_answered() && !booted ? last.latency_ns() : 0;
  if (!booted) replies_.add(std::move(last));
  ask_all(link_, replies_, latency_ns);
}

// Whether a device that sends no reply starts nevertheless.
bool live_run::scans_when_started() {
  const std::uint64_t before = link_.counts().packets;
  link_.send(command::start);
  link_.listen_for(1'500 * ms);
  link_.stop();
  return link_.counts().packets > before;
}

void live_run::look_for_baud_rate(stage_report& baud) {
  if (garbage_ > 0) baud.add("bytes_of_no_packet", garbage_);
  if (find_other_layout(baud, link_.layout())) return;
  std::uint32_t found = 0;
  std::string tried;
  for (const std::uint32_t rate : other_rates) {
    if (!log_.options().reopen || rate == baud_ || link_.is_cancelled() || found != 0) continue;
    link_.replace([&] { return log_.options().reopen(rate); });
    if (link_.is_over()) continue;
    tried.append(tried.empty() ? "" : " ").append(std::to_string(rate));
    link_.send(command::device_info);
    link_.listen_for(400 * ms);
    if (link_.counts().packets + link_.counts().responses > 0) found = rate;
  }
  if (!tried.empty()) baud.add("rates_tried", tried);
  if (found != 0) baud.add("rate_that_works", found);
  if (found != 0 || garbage_ > 0) baud.find(diagnosis::wrong_baud_rate);
}

bool live_run::interview() {
  const auto is_disturbed = [&] {
    return !replies_.exchanges().empty() && replies_.exchanges().back().packets > 0;
  };
  for (int i = 0; i < 2 && !link_.is_over() && !is_deaf_ && is_disturbed(); ++i) {
    answer_.find(diagnosis::was_scanning);
    if (make_quiet()) ask_all(link_, replies_, 0);
  }
  if (!replies_.exchanges().empty()) replies_.judge(answer_, link_.host_pauses() > 0);
  if (link_.boots() > 0) answer_.add("boots", link_.boots());
  if (link_.boots() > 1) answer_.find(diagnosis::reboots);
  add_failure(answer_);
  log_.report(std::move(answer_));
  if (link_.is_over()) return false;
  device_ = replies_.snapshot();
  return report_identity(log_, device_.information) && report_health(log_, device_.condition);
}

}  // namespace g4lidar
