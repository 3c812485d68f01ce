// SPDX-License-Identifier: MIT
// A healthy device gets no diagnosis, whatever its peculiarities; it is left as it was found.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "doctor/doctor_bench.hpp"
#include "g4lidar/sim/random.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;
using g4_dump::stage;
using g4_dump::verdict;

/// Nothing found, nothing left out, and nothing changed.
void expect_healthy(const sim::device_options& options) {
  const examined done = examine(options);
  ASSERT_EQ(done.diagnoses(), "") << done;
  ASSERT_EQ(done.code(), 0) << done;
  ASSERT_EQ(done.stages.size(), g4_dump::stage_count - 3) << done;
  ASSERT_EQ(done.motor_turns, options.initial.idle_power == low_power::off) << done;
  sim::device_settings before = options.initial;
  before.scan_frequency_chz = options.scanner.scan_frequency_chz;
  before.ranging = options.scanner.ranging;
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

/// Healthy, and odd in every way in which a healthy device can be.
sim::device_options odd_device(std::uint64_t seed) {
  choice by(seed);
  sim::device_options options;
  options.scanner.seed = seed;
  options.scanner.ranging = static_cast<ranging_frequency>(by.below(3));
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
  // Packets so small that the line does not carry them are no healthy device's.
  const std::uint64_t least = options.scanner.ranging == ranging_frequency::khz_4 ? 8 : 24;
  if (options.scanner.samples_per_packet < least) options.scanner.samples_per_packet = least;
  return options;
}

TEST(Healthy, AsItComes) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    sim::device_options options;
    options.scanner.seed = seed;
    expect_healthy(options);
    if (HasFatalFailure()) FAIL() << "seed " << seed;
  }
}

TEST(Healthy, WhateverItsPeculiarities) {
  const auto seeds = static_cast<std::uint64_t>(scaled(60));
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    expect_healthy(odd_device(seed));
    if (HasFatalFailure()) FAIL() << "seed " << seed;
  }
}

TEST(Healthy, TellsWhatItMeasured) {
  const examined done = examine({});
  for (const g4_dump::stage_report& report : done.stages) {
    EXPECT_EQ(report.how, verdict::ok) << done;
    EXPECT_FALSE(report.facts.empty()) << done;
  }
  double measured_hz = 0.0;
  for (const g4_dump::fact& each : done.at(stage::rate).facts) {
    if (each.name == "measured_hz") measured_hz = std::get<double>(each.value);
  }
  EXPECT_NEAR(measured_hz, 7.0, 0.05);
  EXPECT_LT(done.seconds, 9.0);
}

TEST(Healthy, OldFirmwareThatTellsNoHealthAtAll) {
  sim::device_options options;
  options.answers_health_91 = false;
  options.answers_health_92 = false;
  const examined done = examine(options);
  EXPECT_EQ(done.diagnoses(), "") << done;
  EXPECT_EQ(done.at(stage::health).how, verdict::skipped);
}

// Not faults of the line, but worth a word.

TEST(Settings, TheProtectionIsFound) {
  for (const bool header : {true, false}) {
    sim::device_options options;
    options.initial.protection = power_down_protection::on;
    options.header_after_protection = header;
    const examined done = examine(options);
    EXPECT_EQ(done.diagnoses(), "protection_on") << done;
    EXPECT_EQ(done.code(), 0);
    EXPECT_EQ(done.settings.protection, power_down_protection::on);
  }
}

TEST(Settings, AMotorThatStands) {
  sim::device_options options;
  options.standstill_ns = 60'000'000'000;
  EXPECT_EQ(examine(options).diagnoses(), "motor_stuck");
}

TEST(Settings, AMotorThatKeepsNoSpeed) {
  sim::device_options options;
  options.free_motor_drift_ppm = 100'000;
  options.motor_drift_ppm = 100'000;
  options.motor_drift_period_ns = 60'000'000'000;
  const std::string found = examine(options).diagnoses();
  EXPECT_TRUE(found == "frequency_off" || found.empty()) << found;
}

TEST(Settings, AnotherModel) {
  sim::device_options options;
  options.info.model = 4;
  const examined done = examine(options);
  EXPECT_EQ(done.diagnoses(), "other_device") << done;
  EXPECT_EQ(done.code(), 7);
  EXPECT_FALSE(done.motor_turns);
}

TEST(Settings, ADefectiveOneThatRefusesToStart) {
  sim::device_options options;
  options.condition = {health_status::error, 3};
  options.error_refuses_start = true;
  EXPECT_EQ(examine(options).diagnoses(), "health_error");
}

TEST(Settings, MoreSamplesThanTheLineCarries) {
  sim::device_options options;
  options.scanner.samples_per_packet = 10;
  const examined done = examine(options);
  EXPECT_EQ(done.diagnoses(), "packets_lost") << done;
}

// The rates that a port can be opened at are tried where nothing makes sense at the first.
TEST(Settings, AnotherBaudRateIsFound) {
  sim::virtual_clock clock;
  const auto garbled = faults_of({"baud", "scanning"});
  sim::device at_230400(sim::built_in_world(), {}, garbled);
  sim::device at_128000(sim::built_in_world(), {});
  g4_dump::exam_options how;
  std::vector<std::uint32_t> tried;
  how.at_rate = [&](std::uint32_t rate) -> std::unique_ptr<transport> {
    tried.push_back(rate);
    if (rate != 128'000) return nullptr;
    return std::make_unique<sim::virtual_port>(at_128000, clock);
  };
  g4_dump::examination exam(std::make_unique<sim::virtual_port>(at_230400, clock), how, {});
  exam.run();
  examined done;
  done.stages = exam.stages();
  EXPECT_EQ(done.diagnoses(), "wrong_baud_rate") << done;
  EXPECT_EQ(done.code(), 6);
  EXPECT_EQ(tried.back(), 128'000U);
  const auto& facts = done.at(stage::baud_rate).facts;
  EXPECT_TRUE(std::any_of(facts.begin(), facts.end(), [](const g4_dump::fact& each) {
    return each.name == "rate_that_works" && each.value == decltype(each.value)(128'000);
  })) << done;
}

TEST(Settings, AnInterruptStopsTheMotor) {
  sim::device twin(sim::built_in_world(), {});
  sim::virtual_clock clock;
  g4_dump::exam_options how;
  how.is_interrupted = [&] { return clock.now_ns() > 4'000'000'000; };
  g4_dump::examination exam(std::make_unique<sim::virtual_port>(twin, clock), how, {});
  exam.run();
  EXPECT_LT(clock.now_ns(), 5'000'000'000);
  static_cast<void>(twin.is_plugged(clock.now_ns()));
  EXPECT_FALSE(twin.motor_turns());
}

TEST(Words, AreCompleteAndTheirNamesDiffer) {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < g4_dump::diagnosis_count; ++i) {
    const g4_dump::diagnosis_words& words = g4_dump::words_of(static_cast<g4_dump::diagnosis>(i));
    EXPECT_EQ(static_cast<std::size_t>(words.what), i) << words.name;
    EXPECT_FALSE(words.cause.empty()) << words.name;
    EXPECT_TRUE(words.advice.ends_with('.')) << words.name;
    EXPECT_NE(words.code, g4_dump::exit_code::ok) << words.name;
    EXPECT_EQ(std::count(names.begin(), names.end(), words.name), 0) << words.name;
    names.push_back(words.name);
  }
}

}  // namespace
