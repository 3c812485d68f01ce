// SPDX-License-Identifier: MIT
// The evidence and the verdict never contradict: each fault of the simulated device, alone, later, and with a lidar that
// was scanning; each verdict is compared with the numbers beside it, after docs/design/doctor.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "diagnostics/doctor_bench.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/sim/device_options.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;
using enum diagnosis;

/// The number of this name in a report; `otherwise` if it has none.
double number_in(const stage_report& report, std::string_view name, double otherwise = 0.0) {
  for (const evidence& each : report.measurements) {
    if (each.name == name) return std::atof(each.text().c_str());
  }
  return otherwise;
}

std::string word_in(const stage_report& report, std::string_view name) {
  for (const evidence& each : report.measurements) {
    if (each.name == name) return each.text();
  }
  return {};
}

bool has(const stage_report& report, diagnosis what) {
  return std::ranges::find(report.diagnoses, what) != report.diagnoses.end();
}

const stage_report* stage_of(const examined& done, diagnostic_stage where) {
  const auto at = std::ranges::find(done.stages, where, &stage_report::stage);
  return at == done.stages.end() ? nullptr : &*at;
}

double sum_of(const examined& done, std::string_view name) {
  double sum = 0.0;
  for (const stage_report& each : done.stages) sum += number_in(each, name);
  return sum;
}

void expect_outcomes(const examined& done) {
  for (const stage_report& each : done.stages) {
    stage_verdict worst = stage_verdict::ok;
    for (const diagnosis what : each.diagnoses) worst = std::max(worst, describe(what).severity);
    const bool is_bad = each.outcome == stage_verdict::warn || each.outcome == stage_verdict::fail;
    EXPECT_EQ(is_bad, !each.diagnoses.empty()) << name_of(each.stage);
    EXPECT_LE(each.outcome, std::max(worst, stage_verdict::skipped)) << name_of(each.stage);
  }
}

/// What is stated about the baud rate, and about silence.
void expect_contact(const examined& done, const stage_report& baud) {
  if (has(baud, wrong_baud_rate)) {
    EXPECT_EQ(sum_of(done, "packets"), 0.0);
    EXPECT_NE(number_in(baud, "rate_that_works"), number_in(baud, "baud"));
  }
  for (const stage_report& each : done.stages) {
    if (each.stage == diagnostic_stage::stream && has(each, wrong_baud_rate)) {
      EXPECT_GT(number_in(each, "bytes_since_last_packet"), 170.0);  // the longest packet
    }
    if (!has(each, silent)) continue;
    for (const char* const name : {"bytes", "packets", "points", "bytes_of_no_packet", "answered"})
      EXPECT_EQ(sum_of(done, name), 0.0) << name;
    for (const stage_report& other : done.stages)
      EXPECT_EQ(other.remark.find(" arrived."), std::string::npos);
  }
}

/// Which model it is, beside the size of its samples and its number. What is stated was measured.
void expect_model(const examined& done, const stage_report& baud, const model& real) {
  const auto size = static_cast<double>(sample_size(real.samples.layout));
  for (const stage_report& each : done.stages)
    EXPECT_EQ(number_in(each, "bytes_per_sample", size), size) << name_of(each.stage);
  const std::string word = word_in(baud, "model");
  if (word.empty()) return;
  const model* const row = model_named(word);
  ASSERT_NE(row, nullptr) << word;
  const stage_report* const identity = stage_of(done, diagnostic_stage::identity);
  if (identity == nullptr || identity->outcome != stage_verdict::ok) return;
  const auto number = static_cast<std::uint8_t>(number_in(*identity, "model"));
  EXPECT_TRUE(detail::may_report(*row, number)) << word << " " << int{number};
}

/// Of each verdict at least one of these numbers is above this one.
void expect_numbers(const examined& done) {
  struct proof {
    diagnosis what;
    diagnostic_stage where;
    std::vector<std::string_view> names;
    double above = 0.0;
  };
  using enum diagnostic_stage;
  const std::vector<std::string_view> skipped{"skipped_noise", "skipped_bad_header",
                                              "skipped_bad_checksum", "skipped_truncated"};
  for (const proof& each : std::initializer_list<proof>{
           {bits_flipped, loss, {"changed"}},
           {bursts, loss, {"changed"}},
           {bytes_dropped, loss, {"shortened"}},
           {packets_truncated, loss, {"cut"}},
           {bytes_inserted, loss, {"lengthened"}},
           {packets_lost, loss, {"vanished", "crc_mismatches", "samples_lost"}},
           {line_noise, loss, skipped},
           {answers_missing, answers, {"missing", "first_answer_after_ms"}},
           {answers_twice, answers, {"twice"}},
           {answers_wrong, answers, {"wrong"}},
           {answers_late, answers, {"late"}, 1.0},
           {jolts, stream, {"jerks"}},
           {host_busy, stream, {"longest_host_pause_ms"}, 149.0},
           {diagnosis::usb_latency, diagnostic_stage::usb_latency, {"held_back_ms"}, 3.3}}) {
    const stage_report* const report = stage_of(done, each.where);
    if (report == nullptr || !has(*report, each.what)) continue;
    if (each.what == answers_missing && report->measurements.empty()) continue;  // it was started
    const bool is_proved = std::ranges::any_of(
        each.names, [&](std::string_view name) { return number_in(*report, name) > each.above; });
    EXPECT_TRUE(is_proved) << describe(each.what).name;
  }
}

void expect_scan(const examined& done) {
  if (const stage_report* const seen = stage_of(done, diagnostic_stage::returns);
      seen != nullptr && seen->outcome != stage_verdict::skipped) {
    EXPECT_EQ(has(*seen, no_returns), number_in(*seen, "returns", -1.0) == 0.0);
  }
  if (const stage_report* const health = stage_of(done, diagnostic_stage::health);
      health != nullptr && health->outcome != stage_verdict::skipped) {
    const std::string status = word_in(*health, "status");
    EXPECT_EQ(has(*health, health_warning), status == "warning");
    EXPECT_EQ(has(*health, health_error), status == "error");
  }
  if (done.diagnoses().empty()) {
    EXPECT_GT(sum_of(done, "packets"), 0.0);
    EXPECT_LT(sum_of(done, "lost_percent"), 0.2);
  }
}

/// Behind a network bridge the line is not at fault: no cable, no ground, no reflection, no USB bridge.
void expect_no_line(const examined& done) {
  for (const stage_report& each : done.stages) {
    std::string text = each.remark;
    for (const diagnosis what : each.diagnoses) {
      EXPECT_NE(what, diagnosis::usb_latency);
      text.append(describe(what).cause);
      if (each.stage == diagnostic_stage::loss) text.append(describe(what).advice);
    }
    for (const char* const word : {"cable", "ground", "reflection", "crosstalk"})
      EXPECT_EQ(text.find(word), std::string::npos) << text;
  }
}

void expect_agreement(const examined& done, const model& real, bool is_network) {
  expect_outcomes(done);
  if (const stage_report* const baud = stage_of(done, diagnostic_stage::baud_rate)) {
    expect_contact(done, *baud);
    expect_model(done, *baud, real);
  }
  expect_numbers(done);
  expect_scan(done);
  if (is_network) expect_no_line(done);
}

/// The kind alone, from 4 s on, and with a lidar that was scanning.
std::vector<std::vector<sim::fault>> faults_with(sim::fault_kind kind) {
  return {{sim::make_fault(kind)},
          {sim::make_fault(kind, 4'000'000'000)},
          {sim::make_fault(sim::fault_kind::scanning), sim::make_fault(kind)}};
}

class Evidence : public ::testing::TestWithParam<std::string_view> {};

TEST_P(Evidence, AgreesWithTheVerdict) {
  const model& real = *model_named(GetParam());
  auto run = static_cast<std::size_t>(*seeds(1).begin());
  for (std::size_t i = 0; i <= static_cast<std::size_t>(sim::last_fault_kind); ++i) {
    const auto kind = static_cast<sim::fault_kind>(i);
    for (const auto& faults : faults_with(kind)) {
      for (const bool is_named : {true, false}) {
        sim::device_options options;
        ASSERT_TRUE(sim::use_model(options, real.word));
        options.scanner.seed = ++run;
        sim::device simulated(sim::built_in_world(), options, faults);
        sim::virtual_clock clock;
        diagnostic_options how{.model = is_named ? &real : nullptr};
        how.measuring_time = std::chrono::seconds(2);
        const bool is_network = run % 3 == 0;
        auto port = std::make_unique<sim::virtual_port>(simulated, clock,
                                                        is_network ? "tcp:bridge" : "virtual:line");
        static_cast<void>(port->set_baud(is_named ? real.bauds[0] : 230'400));  // not if unplugged
        examined done;
        done.stages = diagnose(std::move(port), how);
        const std::string name(sim::name_of(kind));
        SCOPED_TRACE(name + (faults.size() > 1 ? ", scanning" : "") +
                     (is_named ? ", named" : ", not named") + (is_network ? ", network" : ""));
        expect_agreement(done, real, is_network);
        if (HasFailure()) FAIL() << done;
      }
    }
  }
}

/// In the nightly all of them.
std::vector<std::string_view> examined_models() {
  const auto all = sim::model_words();
  if (test_scale() > 1) return {all.begin(), all.end()};
  return {"g4", "x4", "t-mini-pro", "x2", "tg30", "s2-intensity"};
}

INSTANTIATE_TEST_SUITE_P(Models, Evidence, ::testing::ValuesIn(examined_models()),
                         [](const auto& of) {
                           std::string name(of.param);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
