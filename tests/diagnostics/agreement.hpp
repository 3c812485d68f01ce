// SPDX-License-Identifier: MIT
// Each verdict is compared with the numbers beside it, after docs/design/doctor.md.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
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
#include "g4lidar/transport/transport.hpp"

namespace g4lidar::test {

/// A network bridge: its rate is not known and cannot be set.
class network_port final : public forwarding_transport {
 public:
  using forwarding_transport::forwarding_transport;
  [[nodiscard]] std::string_view name() const noexcept override { return "tcp:bridge:4000"; }
  [[nodiscard]] result<bool> set_baud(std::uint32_t /*baud*/) noexcept override { return false; }
  [[nodiscard]] result<bool> set_dtr(bool /*high*/) noexcept override { return false; }
};

/// The number of this name in a report; `otherwise` if it has none.
inline double number_in(const stage_report& report, std::string_view name, double otherwise = 0.0) {
  for (const evidence& each : report.measurements) {
    if (each.name == name) return std::atof(each.text().c_str());
  }
  return otherwise;
}

inline std::string word_in(const stage_report& report, std::string_view name) {
  for (const evidence& each : report.measurements) {
    if (each.name == name) return each.text();
  }
  return {};
}

inline bool has(const stage_report& report, diagnosis what) {
  return std::ranges::find(report.diagnoses, what) != report.diagnoses.end();
}

inline const stage_report* stage_of(const examined& done, diagnostic_stage where) {
  const auto at = std::ranges::find(done.stages, where, &stage_report::stage);
  return at == done.stages.end() ? nullptr : &*at;
}

inline double sum_of(const examined& done, std::string_view name) {
  double sum = 0.0;
  for (const stage_report& each : done.stages) sum += number_in(each, name);
  return sum;
}

inline void expect_outcomes(const examined& done) {
  for (const stage_report& each : done.stages) {
    stage_verdict worst = stage_verdict::ok;
    for (const diagnosis what : each.diagnoses) worst = std::max(worst, describe(what).severity);
    const bool is_bad = each.outcome == stage_verdict::warn || each.outcome == stage_verdict::fail;
    EXPECT_EQ(is_bad, !each.diagnoses.empty()) << name_of(each.stage);
    EXPECT_LE(each.outcome, std::max(worst, stage_verdict::skipped)) << name_of(each.stage);
  }
}

/// What is stated about the baud rate, and about silence.
inline void expect_contact(const examined& done, const stage_report& baud) {
  using enum diagnosis;
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
inline void expect_model(const examined& done, const stage_report& baud, const model& real) {
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
inline void expect_numbers(const examined& done) {
  struct proof {
    diagnosis what;
    diagnostic_stage where;
    std::vector<std::string_view> names;
    double above = 0.0;
  };
  using enum diagnosis;
  const std::vector<std::string_view> skipped{"skipped_noise", "skipped_bad_header",
                                              "skipped_bad_checksum", "skipped_truncated"};
  for (const proof& each : std::initializer_list<proof>{
           {bits_flipped, diagnostic_stage::loss, {"changed"}},
           {bursts, diagnostic_stage::loss, {"changed"}},
           {bytes_dropped, diagnostic_stage::loss, {"shortened"}},
           {packets_truncated, diagnostic_stage::loss, {"cut"}},
           {bytes_inserted, diagnostic_stage::loss, {"lengthened"}},
           {packets_lost, diagnostic_stage::loss, {"vanished", "crc_mismatches", "samples_lost"}},
           {line_noise, diagnostic_stage::loss, skipped},
           {answers_missing, diagnostic_stage::answers, {"missing", "first_answer_after_ms"}},
           {answers_twice, diagnostic_stage::answers, {"twice"}},
           {answers_wrong, diagnostic_stage::answers, {"wrong"}},
           {answers_late, diagnostic_stage::answers, {"late"}, 1.0},
           {jolts, diagnostic_stage::stream, {"jerks"}},
           {host_busy, diagnostic_stage::stream, {"longest_host_pause_ms"}, 149.0},
           {usb_latency, diagnostic_stage::usb_latency, {"held_back_ms"}, 3.3}}) {
    const stage_report* const report = stage_of(done, each.where);
    if (report == nullptr || !has(*report, each.what)) continue;
    if (each.what == answers_missing && report->measurements.empty()) continue;  // it was started
    const bool is_proved = std::ranges::any_of(
        each.names, [&](std::string_view name) { return number_in(*report, name) > each.above; });
    EXPECT_TRUE(is_proved) << describe(each.what).name;
  }
}

inline void expect_scan(const examined& done) {
  using enum diagnosis;
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

/// The words that blame a line of this computer.
inline void expect_no_line(std::string_view text) {
  for (const char* const word :
       {"cable", "ground", "reflection", "crosstalk", "USB", "usb", "hub", "wires between"})
    EXPECT_EQ(text.find(word), std::string_view::npos) << word << ": " << text;
}

/// Behind a network bridge the line is not at fault: no cable, no ground, no reflection, no USB bridge.
inline void expect_no_line(const examined& done) {
  for (const stage_report& each : done.stages) {
    if (each.stage != diagnostic_stage::usb_latency) expect_no_line(each.remark);
    for (const diagnosis what : each.diagnoses) {
      const diagnosis_info info = each.explain(what);
      EXPECT_NE(what, diagnosis::usb_latency);
      expect_no_line(info.cause);
      expect_no_line(info.advice);
      for (const diagnosis other : info.alternatives) EXPECT_NE(other, diagnosis::line_noise);
    }
  }
}

/// A time without bytes has its length beside it.
inline void expect_lengths(const examined& done) {
  constexpr double stall_ms = 149.0;
  for (const stage_report& each : done.stages) {
    if (!has(each, diagnosis::stalls)) continue;
    const double length_ms =
        std::max({number_in(each, "longest_silence_ms"), number_in(each, "silence_ms"),
                  each.stage == diagnostic_stage::answers ? number_in(each, "slowest_ms") : 0.0});
    EXPECT_GT(length_ms, stall_ms) << name_of(each.stage);
  }
}

/// What is reported about the number, and how often.
inline void expect_number(const examined& done) {
  int reported = 0;
  for (const stage_report& each : done.stages) {
    reported += static_cast<int>(std::ranges::count(each.diagnoses, diagnosis::other_number));
    for (const diagnosis what : each.diagnoses) {
      const bool is_insisting = each.explain(what).advice.find("insist") != std::string_view::npos;
      EXPECT_TRUE(!is_insisting || each.stage == diagnostic_stage::identity) << name_of(each.stage);
      if (is_insisting) {
        EXPECT_EQ(number_in(each, "bytes_per_sample"), 0.0);
      }
    }
  }
  EXPECT_LE(reported, 1);
}

inline void expect_agreement(const examined& done, const model& real, bool is_network) {
  expect_outcomes(done);
  if (const stage_report* const baud = stage_of(done, diagnostic_stage::baud_rate)) {
    expect_contact(done, *baud);
    expect_model(done, *baud, real);
  }
  expect_numbers(done);
  expect_lengths(done);
  expect_number(done);
  expect_scan(done);
  if (is_network) expect_no_line(done);
}

}  // namespace g4lidar::test
