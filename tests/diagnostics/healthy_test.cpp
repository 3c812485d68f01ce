// SPDX-License-Identifier: MIT
// A healthy device gets no diagnosis, with all its peculiarities; its state is not changed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "diagnostics/doctor_bench.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/sim/random.hpp"
#include "g4lidar/transport/transport.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;

/// No diagnosis, no stage left out, and no setting changed.
void expect_healthy(const sim::device_options& options) {
  const examined done = examine(options);
  ASSERT_EQ(done.diagnoses(), "") << done;
  ASSERT_FALSE(done.fails()) << done;
  ASSERT_EQ(done.stages.size(), diagnostic_stage_count - 3) << done;
  ASSERT_EQ(done.motor_turns, options.initial.idle_power == low_power::off) << done;
  sim::device_settings before = options.initial;
  before.scan_frequency_chz = options.scanner.scan_frequency_chz;
  before.sample_rate = options.scanner.sample_rate;
  ASSERT_EQ(done.settings, before) << done;
}

/// One of two, by a bit of the seed's random numbers.
class choice {
 public:
  explicit choice(std::uint64_t seed) : random_(seed) {}
  [[nodiscard]] std::uint64_t below(std::uint64_t count) { return (random_.next() >> 32) % count; }
  [[nodiscard]] bool flip() { return below(2) == 0; }

 private:
  sim::random_stream random_;
};

/// Healthy, and different in every property in which healthy devices can differ.
sim::device_options odd_device(std::uint64_t seed) {
  choice by(seed);
  sim::device_options options;
  options.scanner.seed = seed;
  options.scanner.sample_rate = *reply_byte<sample_rate>(static_cast<std::uint8_t>(by.below(3)));
  options.scanner.scan_frequency_chz = static_cast<std::uint16_t>(500 + 50 * by.below(15));
  options.scanner.samples_per_packet = 24 + by.below(57);
  options.scanner.reports_frequency = by.flip();
  options.scanner.noise_mm = by.flip() ? 0.0 : 5.0;
  options.scanner.dropout_ratio = by.flip() ? 0.0 : 0.2;
  options.scanner.sample_rate_ratio = 0.95 + 0.01 * static_cast<double>(by.below(11));
  options.scanner.ordinary_ct = by.flip() ? 0 : 0x86;
  options.batch_max_ns = by.flip() ? 1'000'000 : 2'000'000;
  options.reaction_ns = by.flip() ? 1'000'000 : 20'000'000;
  options.acceleration_mhz_per_s = by.flip() ? 14'000 : 5'000;
  options.standstill_ns = by.flip() ? 60'000'000 : 400'000'000;
  options.stop_ns = by.flip() ? 0 : 300'000'000;
  options.stray_after_start = by.flip();
  options.stray_before_zero = by.flip();
  options.stop_truncates = by.flip();
  options.boot_text = by.flip();
  options.boot_information = by.flip();
  options.boots_at_start = by.flip();
  options.boot_ns = by.flip() ? 400'000'000 : 900'000'000;
  options.answers_direction = by.flip();
  options.answers_health_91 = by.flip();
  options.answers_health_92 = !options.answers_health_91 || by.flip();
  options.obeys_forced_stop = by.flip();
  options.start_again_answers = by.flip();
  options.while_scanning = static_cast<sim::disturbance>(by.below(4));
  options.initial.direction = static_cast<motor_direction>(by.below(2));
  options.initial.constancy = static_cast<constant_frequency>(by.below(2));
  options.initial.idle_power = by.below(4) == 0 ? low_power::off : low_power::on;
  options.ct_crc = by.flip();
  options.time_packet_ns = by.flip() ? 0 : 100'000'000;
  // Packets so small that they exceed the capacity of the connection do not occur in a healthy
  // device.
  const std::uint64_t least = options.scanner.sample_rate == sample_rate::khz_4 ? 8 : 24;
  if (options.scanner.samples_per_packet < least) options.scanner.samples_per_packet = least;
  return options;
}

TEST(Healthy, DefaultDevice_HasNoDiagnosis) {
  for (const int seed : test::seeds(10)) {
    sim::device_options options;
    options.scanner.seed = static_cast<std::uint64_t>(seed);
    expect_healthy(options);
    if (HasFatalFailure()) FAIL() << "seed " << seed;
  }
}

TEST(Healthy, UnusualDevices_HaveNoDiagnosis) {
  for (const int each : test::seeds(60)) {
    const auto seed = static_cast<std::uint64_t>(each);
    expect_healthy(odd_device(seed));
    if (HasFatalFailure()) FAIL() << "seed " << seed;
  }
}

TEST(Healthy, ReportsItsMeasurements) {
  const examined done = examine({});
  for (const stage_report& report : done.stages) {
    EXPECT_EQ(report.outcome, stage_verdict::ok) << done;
    EXPECT_FALSE(report.measurements.empty()) << done;
  }
  double measured_hz = 0.0;
  for (const evidence& each : done.at(diagnostic_stage::rate).measurements) {
    if (each.name == "measured_hz") measured_hz = std::get<double>(each.value);
  }
  EXPECT_NEAR(measured_hz, 7.0, 0.05);
  EXPECT_LT(done.seconds, 9.0);
}

TEST(Healthy, OldFirmwareWithoutHealth) {
  sim::device_options options;
  options.answers_health_91 = false;
  options.answers_health_92 = false;
  const examined done = examine(options);
  EXPECT_EQ(done.diagnoses(), "") << done;
  EXPECT_EQ(done.at(diagnostic_stage::health).outcome, stage_verdict::skipped);
}

// Not faults of the connection, but reported.

TEST(Settings, ProtectionOn_IsFound) {
  for (const bool header : {true, false}) {
    sim::device_options options;
    options.initial.protection = power_down_protection::on;
    options.header_after_protection = header;
    const examined done = examine(options);
    EXPECT_EQ(done.diagnoses(), "protection_on") << done;
    EXPECT_FALSE(done.fails());
    EXPECT_EQ(done.settings.protection, power_down_protection::on);
  }
}

// The speed hardly changes during a run: the true value at its end determines the expected result.
TEST(Settings, UnsteadyMotor_IsFound) {
  int off = 0;
  const auto seeds = test::seeds(12);
  for (const int seed : seeds) {
    sim::device_options options;
    options.scanner.seed = static_cast<std::uint64_t>(seed);
    options.motor_drift_ppm = 100'000;
    options.motor_drift_period_ns = 1'000'000'000'000;
    sim::device simulated(sim::built_in_world(), options);
    sim::virtual_clock clock;
    diagnostic_options how;
    double true_hz = 0.0;
    how.on_stage = [&](const stage_report& report) {
      if (report.stage == diagnostic_stage::motor)
        true_hz = simulated.motor_mhz(clock.now_ns()) / 1e3;
    };
    const examined done = examine(simulated, clock, how);
    const double off_ratio = std::abs(true_hz / 7.0 - 1.0);
    if (off_ratio > 0.055 && off_ratio < 0.065) continue;  // both results are possible
    EXPECT_EQ(done.diagnoses(), off_ratio > 0.06 ? "frequency_off" : "") << true_hz << done;
    off += off_ratio > 0.06 ? 1 : 0;
  }
  EXPECT_GT(off, 0);
  EXPECT_LT(off, static_cast<int>(seeds.size()));
}

TEST(Settings, DefectiveDeviceThatDoesNotStart) {
  sim::device_options options;
  options.condition = {health_status::error, 3};
  options.error_refuses_start = true;
  EXPECT_EQ(examine(options).diagnoses(), "health_error");
}

// The rate that the user gave is not that of the device: the report has the right one.
TEST(Settings, OtherBaudRate_IsFound) {
  for (const bool scans : {false, true}) {
    sim::device_options options;
    options.baud = 128'000;
    diagnostic_options how;
    how.baud = 230'400;
    const auto scanning = faults_of({"scanning"});
    sim::device simulated(
        sim::built_in_world(), options,
        scans ? std::span<const sim::fault>(scanning) : std::span<const sim::fault>());
    sim::virtual_clock clock;
    const examined done = examine(simulated, clock, how);
    EXPECT_EQ(done.diagnoses(), "wrong_baud_rate") << done;
    EXPECT_TRUE(done.fails());
    EXPECT_FALSE(done.motor_turns);
    const stage_report& baud = done.at(diagnostic_stage::baud_rate);
    EXPECT_EQ(baud.remark, "The bytes are right at 128000 baud: those of a G4.");
    EXPECT_TRUE(std::any_of(baud.measurements.begin(), baud.measurements.end(),
                            [](const evidence& each) {
                              return each.name == "rate_that_works" &&
                                     each.value == decltype(each.value)(128'000);
                            }))
        << done;
  }
}

/// A port whose bridge makes another rate than the one that was set.
class port_at final : public forwarding_transport {
 public:
  port_at(std::unique_ptr<transport> inner, std::uint32_t baud)
      : forwarding_transport(std::move(inner)), baud_(baud) {}
  [[nodiscard]] std::uint32_t baud() const noexcept override { return baud_; }

 private:
  std::uint32_t baud_;
};

TEST(Settings, RateThatTheBridgeCannotMake_IsARemark) {
  const auto remark_at = [](std::uint32_t baud) {
    sim::virtual_clock clock;
    sim::device healthy(sim::built_in_world(), {});
    auto port =
        std::make_unique<port_at>(std::make_unique<sim::virtual_port>(healthy, clock), baud);
    for (const stage_report& each : diagnose(std::move(port))) {
      EXPECT_TRUE(each.diagnoses.empty());
      if (each.stage == diagnostic_stage::baud_rate) return each.remark;
    }
    return std::string("no such stage");
  };
  EXPECT_EQ(remark_at(230'400), "");
  EXPECT_EQ(remark_at(230'769), "");
  EXPECT_EQ(remark_at(225'000), "The port runs at 225000 baud instead of 230400.");
}

TEST(Settings, Cancellation_StopsTheMotor) {
  sim::device simulated(sim::built_in_world(), {});
  sim::virtual_clock clock;
  diagnostic_options how;
  how.is_cancelled = [&] { return clock.now_ns() > 4'000'000'000; };
  const examined done = examine(simulated, clock, how);
  EXPECT_LT(clock.now_ns(), 5'000'000'000);
  EXPECT_FALSE(done.motor_turns);
}

TEST(Words, AreCompleteWithDifferentNames) {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < diagnosis_count; ++i) {
    const diagnosis_info& words = describe(static_cast<diagnosis>(i));
    EXPECT_FALSE(words.cause.empty()) << words.name;
    EXPECT_TRUE(words.advice.ends_with('.')) << words.name;
    EXPECT_GE(words.severity, stage_verdict::warn) << words.name;
    EXPECT_EQ(std::count(names.begin(), names.end(), words.name), 0) << words.name;
    names.push_back(words.name);
  }
}

}  // namespace
