// SPDX-License-Identifier: MIT
// The stage rate: the speed of the motor and of the samples, and how it is set.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/number_text.hpp"
#include "g4lidar/options/option_table.hpp"
#include "stages.hpp"

namespace g4lidar {
namespace {

constexpr double frequency_tolerance = 0.06;
constexpr double sample_rate_tolerance = 0.12;
/// Between the rates of different models: of a G4 4000, 8000 and 9000, of others 5000 and 10000.
constexpr double other_model_tolerance = 0.06;
/// How far a number of samples per revolution may be beyond those at the limits of rate and frequency.
constexpr double revolution_tolerance = 0.1;

/// The possible error of a measured rate, as a fraction, if bytes came late by the longest silence.
double doubt_of(const stream_tally& measured) {
  const double silence_s = static_cast<double>(measured.arrivals.longest_silence_ns()) * 1e-9;
  const double samples = static_cast<double>(measured.samples);
  return samples > 0.0 ? silence_s * measured.sample_rate_hz() / samples : 0.0;
}

/// Whether the rate is not that of the manual, but devices of the model have it. Reports that.
bool is_rate_of_owners(stage_report& rate, double rate_hz, const model& wanted) {
  const double manual_hz = wanted.rates.nominal_hz;
  const bool is_near = std::abs(rate_hz - manual_hz) <= other_model_tolerance * manual_hz;
  if (is_near || !is_seen_rate(wanted, rate_hz)) return false;
  rate.remark = std::to_string(std::lround(rate_hz)) + " samples per second, " +
                std::to_string(wanted.rates.nominal_hz) + " by the manual: owners of " +
                one_of(wanted) + " see " + std::to_string(wanted.rates.least_seen_hz) + " to " +
                std::to_string(wanted.rates.most_seen_hz) + ".";
  return true;
}

/// Bytes without device information: a speed that no lidar like `wanted` has is that of another model.
void find_other_speed(stage_report& rate, double rate_hz, double samples_per_revolution,
                      const model& wanted, double doubt = 0.0) {
  std::vector<double> rates;
  for (const sample_rate_entry& each : wanted.rates.entries) {
    if (each.hz != 0) rates.push_back(each.hz);
  }
  const auto is_near = [rate_hz, doubt](double nominal) {
    return std::abs(rate_hz - nominal) <= (other_model_tolerance + doubt) * nominal;
  };
  const bool is_known_rate = rate_hz <= 0.0 || std::ranges::any_of(rates, is_near) ||
                             is_rate_of_owners(rate, rate_hz, wanted);
  const double least_hz = wanted.frequency.min_chz / 100.0;
  const double most_hz = wanted.frequency.max_chz / 100.0;  // 0: not known
  const bool is_possible =
      most_hz <= 0.0 ||
      (samples_per_revolution >= (1.0 - revolution_tolerance) * rates.front() / most_hz &&
       samples_per_revolution <= (1.0 + revolution_tolerance) * rates.back() / least_hz);
  if (is_known_rate && is_possible) return;
  rate.find(diagnosis::other_device);
  rate.outcome = std::min(rate.outcome, stage_verdict::warn);
  const auto in_words = [](double hz) { return std::to_string(std::lround(hz)); };
  rate.remark =
      one_of(wanted) + " measures " + list_of(rates, in_words, " or ") + " samples per second";
  rate.remark.front() = 'A';  // "An X4"
  if (most_hz > 0.0) {
    rate.remark += " at " + std::to_string(std::lround(least_hz)) + " to " +
                   std::to_string(std::lround(most_hz)) + " Hz";
  }
  rate.remark += ".";
}

/// The sample rate that the lidar reports, or else the nearest one of `wanted`, if it has identified
/// itself as one; 0: neither.
double nominal_rate_hz(const device_snapshot& known, double measured_hz, const model& wanted) {
  if (known.sample_rate_hz) return *known.sample_rate_hz;
  if (!known.information || !detail::may_report(wanted, known.information->model)) return 0.0;
  double nearest_hz = 0.0;
  for (const sample_rate_entry& each : wanted.rates.entries) {
    if (each.hz == 0) continue;
    const double hz = each.hz;
    if (nearest_hz == 0.0 || std::abs(hz - measured_hz) < std::abs(nearest_hz - measured_hz)) {
      nearest_hz = hz;
    }
  }
  return nearest_hz;
}

}  // namespace

bool is_host_busy(const stream_statistics& measured) noexcept {
  return measured.tally().arrivals.longest_host_pause_ns() >= arrival_statistics::stall_ns;
}

void report_rate(stage_log& log, const stream_statistics& measured, const device_snapshot& known,
                 const model& wanted) {
  const double frequency_hz = measured.tally().frequency_hz();
  const double rate_hz = measured.tally().sample_rate_hz();
  // Late arrivals look like another rate: because the computer is busy, or was when this was recorded. So do whole
  // revolutions that are lost.
  const double doubt = doubt_of(measured.tally());
  const double all_stalls = static_cast<double>(measured.tally().arrivals.stalls()) * doubt;
  const bool is_certain =
      !is_host_busy(measured) && all_stalls < frequency_tolerance && !is_mostly_damaged(measured);
  stage_report rate{.stage = diagnostic_stage::rate};
  const double reported_hz = true_frequency_chz(wanted, measured.tally().reported_chz()) / 100.0;
  if (reported_hz > 0.0) rate.add("reported_hz", reported_hz);
  if (measured.tally().turns_per_sample() > 0.0) {
    rate.add("samples_per_revolution", 1.0 / measured.tally().turns_per_sample());
  }
  const bool is_unknown_model = !known.information && !known.sample_rate_hz && is_certain &&
                                measured.was_steady() && measured.tally().turns_per_sample() > 0.0;
  if (frequency_hz <= 0.0) {
    rate.outcome = stage_verdict::skipped;
    rate.remark = "There is too little with times to measure it.";
    const double turns = measured.tally().turns_per_sample();
    if (is_unknown_model) find_other_speed(rate, reported_hz / turns, 1.0 / turns, wanted);
    return log.report(std::move(rate));
  }
  rate.add("measured_hz", frequency_hz);
  if (known.frequency) {
    const double set_hz = known.frequency->chz / 100.0;
    rate.add("set_hz", set_hz);
    const bool is_off = std::abs(frequency_hz - set_hz) > (frequency_tolerance + doubt) * set_hz;
    if (is_off && is_certain && measured.was_steady()) rate.find(diagnosis::frequency_off);
  }
  rate.add("sample_rate_hz", rate_hz);
  if (is_unknown_model) {
    find_other_speed(rate, rate_hz, 1.0 / measured.tally().turns_per_sample(), wanted, doubt);
  }
  if (const double nominal_hz = nominal_rate_hz(known, rate_hz, wanted); nominal_hz > 0.0) {
    rate.add("expected_sample_rate_hz", nominal_hz);
    const bool is_off =
        std::abs(rate_hz - nominal_hz) > (sample_rate_tolerance + doubt) * nominal_hz &&
        !is_rate_of_owners(rate, rate_hz, wanted);
    if (is_off && is_certain) rate.find(diagnosis::sample_rate_off);
  }
  if (const std::string how = speed_without_commands(wanted); !how.empty()) {
    rate.remark += (rate.remark.empty() ? "" : " ") + ("Its speed: " + how + ".");
  }
  log.report(std::move(rate));
}

}  // namespace g4lidar
