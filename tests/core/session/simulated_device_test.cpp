// SPDX-License-Identifier: MIT
// Every request with the simulated device, healthy and with each fault of its answers: the result
// of the session is the value in the device.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/session/on_simulator.hpp"
#include "core/session/played.hpp"
#include "g4lidar/core/session.hpp"

namespace g4lidar::test {
namespace {

using sim::device_options;
using sim::fault;
using sim::fault_kind;

constexpr std::int64_t s = 1'000 * ms;

struct asked_and_set {
  std::string name;
  request wanted;
  bool (*holds)(const sim::device_settings&);
};

const std::vector<asked_and_set>& settings() {
  using state = const sim::device_settings&;
  static const std::vector<asked_and_set> all{
      {"low power off", requests::set(low_power::off),
       [](state now) { return now.idle_power == low_power::off; }},
      {"low power on", requests::set(low_power::on),
       [](state now) { return now.idle_power == low_power::on; }},
      {"counter-clockwise", requests::set(motor_direction::counter_clockwise),
       [](state now) { return now.direction == motor_direction::counter_clockwise; }},
      {"clockwise", requests::set(motor_direction::clockwise),
       [](state now) { return now.direction == motor_direction::clockwise; }},
      {"frequency up", requests::set(scan_frequency{1040}),
       [](state now) { return now.scan_frequency_chz == 1040; }},
      {"frequency down", requests::set(scan_frequency{530}),
       [](state now) { return now.scan_frequency_chz == 530; }},
      {"no constant frequency", requests::set(constant_frequency::off),
       [](state now) { return now.constancy == constant_frequency::off; }},
      {"4 kHz", requests::set(sample_rate::khz_4),
       [](state now) { return now.sample_rate == sample_rate::khz_4; }},
      {"8 kHz", requests::set(sample_rate::khz_8),
       [](state now) { return now.sample_rate == sample_rate::khz_8; }},
      {"9 kHz", requests::set(sample_rate::khz_9),
       [](state now) { return now.sample_rate == sample_rate::khz_9; }},
      {"protection on", requests::set(power_down_protection::on),
       [](state now) { return now.protection == power_down_protection::on; }},
      {"protection off", requests::set(power_down_protection::off),
       [](state now) { return now.protection == power_down_protection::off; }},
  };
  return all;
}

const std::array<request, 8> others{requests::device_info(),     requests::health(),
                                    requests::get_low_power(),   requests::get_direction(),
                                    requests::get_sample_rate(), requests::get_scan_frequency(),
                                    requests::restart(),         requests::start()};

/// Only start and stop may reach a scanning device.
void expect_undisturbed(const on_simulator& bench) {
  for (const sim::asked& asked : bench.device.log()) {
    if (!asked.scanning) continue;
    const auto traits = traits_of(static_cast<command>(asked.code));
    EXPECT_TRUE(traits && traits->allowed_while_scanning) << static_cast<int>(asked.code);
  }
}

void expect_idle_after_stop(on_simulator& bench) {
  const auto stopped = bench.ask(requests::stop());
  ASSERT_TRUE(stopped);
  EXPECT_EQ(stopped->how, verdict::answered);
  EXPECT_TRUE(bench.device.is_idle_and_silent(bench.now_ns));
}

TEST(session_on_simulator, ReachesEverySetting) {
  for (const device_options& options : {device_options{}, [] {
                                          device_options worn;
                                          worn.batch_max_ns = 16 * ms;
                                          worn.answers_health_91 = false;
                                          worn.frequency_at_limit = sim::at_limit::refuse;
                                          return worn;
                                        }()}) {
    on_simulator bench(options);
    for (const auto& [name, wanted, holds] : settings()) {
      const auto done = bench.ask(wanted);
      ASSERT_TRUE(done) << name;
      EXPECT_EQ(done->how, verdict::answered) << name;
      EXPECT_TRUE(holds(bench.device.settings())) << name;
      EXPECT_EQ(done->retries, 0) << name;
    }
    for (const request& wanted : others) {
      const auto done = bench.ask(wanted);
      ASSERT_TRUE(done);
      EXPECT_EQ(done->how, verdict::answered);
    }
    bench.run_for(1 * s);
    EXPECT_GT(bench.packets, 50U);
    EXPECT_TRUE(bench.reported.empty());
    expect_undisturbed(bench);
    expect_idle_after_stop(bench);
  }
}

/// Under a fault every request ends, and a setting reported as set is set.
void test_with(const fault& bad, bool must_be_answered, bool in_order = true) {
  SCOPED_TRACE(std::string(name_of(bad.kind)) + " rate " + std::to_string(bad.rate));
  on_simulator bench({}, std::array{bad});
  for (const auto& [name, wanted, holds] : settings()) {
    SCOPED_TRACE(name);
    const auto done = bench.ask(wanted);
    ASSERT_TRUE(done);
    EXPECT_TRUE(done->how == verdict::answered || !must_be_answered) << word_for(done->how);
    EXPECT_TRUE(done->how == verdict::answered || done->how == verdict::timed_out);
    // The protection cannot be queried: an answer that is overtaken by later ones is accepted.
    if (wanted.what == request_kind::set_protection && !in_order) continue;
    EXPECT_TRUE(done->how == verdict::timed_out || holds(bench.device.settings()));
  }
  for (const request& wanted : others) {
    SCOPED_TRACE(static_cast<int>(wanted.what));
    const auto done = bench.ask(wanted);
    ASSERT_TRUE(done);
    EXPECT_TRUE(done->how == verdict::answered || !must_be_answered) << word_for(done->how);
  }
  bench.run_for(1 * s);
  expect_undisturbed(bench);
  expect_idle_after_stop(bench);
}

fault always(fault_kind kind, double rate = 1.0, std::int64_t amount = 0) {
  fault made = sim::make_fault(kind);
  made.rate = rate;
  if (amount > 0) made.amount = amount;
  return made;
}

TEST(session_on_simulator, ToleratesDuplicatedAnswers) {
  test_with(always(fault_kind::twice), true);
  test_with(always(fault_kind::twice, 0.5), true);
}
TEST(session_on_simulator, ToleratesLateAnswers) {
  test_with(always(fault_kind::late), true);
  for (const std::int64_t late_ms : {5, 40, 60, 299, 310, 450}) {
    test_with(always(fault_kind::late, 1.0, late_ms * ms), late_ms < 450);
    test_with(always(fault_kind::late, 0.3, late_ms * ms), true, late_ms < 300);
  }
}
TEST(session_on_simulator, ToleratesMissingAnswers) {
  test_with(always(fault_kind::mute), false);
  test_with(always(fault_kind::mute, 0.2), false);
  test_with(always(fault_kind::mute, 0.5), false);
}
TEST(session_on_simulator, ToleratesWrongAnswers) {
  test_with(always(fault_kind::wrong), false);
  test_with(always(fault_kind::wrong, 0.2), false);
  test_with(always(fault_kind::wrong, 0.5), false);
}
TEST(session_on_simulator, ToleratesDamage) {
  for (const fault_kind kind : {fault_kind::drop, fault_kind::insert, fault_kind::burst}) {
    test_with(always(kind, 0.01), false);
  }
  test_with(always(fault_kind::batch), true);
}

TEST(session_on_simulator, LostAnswer_CostsOnlyTime) {
  for (const fault_kind kind : {fault_kind::mute, fault_kind::wrong, fault_kind::twice}) {
    for (const auto& [name, wanted, holds] : settings()) {
      for (std::int64_t at = 0; at < 100 * ms; at += 2 * ms) {
        fault once = sim::make_fault(kind, 10 * s + 50 * ms + at, 2 * ms);
        once.rate = 1.0;
        on_simulator bench({}, std::array{once});
        const auto done = bench.ask(wanted);
        ASSERT_TRUE(done);
        EXPECT_EQ(done->how, verdict::answered) << name;
        EXPECT_TRUE(holds(bench.device.settings())) << name << name_of(kind) << at;
      }
    }
  }
}

TEST(session_on_simulator, DiagnosesTheConnection) {
  on_simulator dead({}, std::array{always(fault_kind::deaf)});
  auto done = dead.ask(requests::device_info());
  ASSERT_TRUE(done);
  EXPECT_EQ(done->how, verdict::timed_out);
  EXPECT_TRUE(done->heard_nothing());

  const std::array streaming{always(fault_kind::deaf), sim::make_fault(fault_kind::scanning)};
  on_simulator runaway({}, streaming);
  done = runaway.ask(requests::device_info());
  ASSERT_TRUE(done);
  EXPECT_EQ(done->how, verdict::still_scanning);
  EXPECT_EQ(runaway.reported, std::vector{notice::found_scanning});

  const std::array strange{always(fault_kind::baud), sim::make_fault(fault_kind::scanning)};
  on_simulator garbled({}, strange);
  done = garbled.ask(requests::device_info());
  ASSERT_TRUE(done);
  EXPECT_EQ(done->how, verdict::timed_out);
  EXPECT_TRUE(done->heard_noise_only());
}

TEST(session_on_simulator, StopsAScanThatWasRunning) {
  for (const auto& [name, wanted, holds] : settings()) {
    on_simulator bench({}, std::array{sim::make_fault(fault_kind::scanning, 9 * s)});
    bench.run_for(1);
    const auto done = bench.ask(wanted);
    ASSERT_TRUE(done);
    EXPECT_EQ(done->how, verdict::answered) << name;
    EXPECT_TRUE(holds(bench.device.settings())) << name;
    EXPECT_EQ(bench.reported, std::vector{notice::found_scanning});
    expect_undisturbed(bench);
  }
}

TEST(session_on_simulator, KeepsAProtectedScanAlive) {
  on_simulator bench;
  ASSERT_TRUE(bench.ask(requests::set(power_down_protection::on)));
  ASSERT_TRUE(bench.ask(requests::start()));
  bench.run_for(30 * s);
  EXPECT_TRUE(bench.device.is_scanning());
  EXPECT_TRUE(bench.reported.empty());
  expect_undisturbed(bench);
  bench.now_ns += 5 * s;  // the caller is suspended
  bench.run_for(1 * s);
  EXPECT_EQ(bench.reported, std::vector{notice::protection_starved});
  EXPECT_TRUE(bench.device.is_scanning());
  expect_idle_after_stop(bench);
}

TEST(session_on_simulator, DetectsThatTheProtectionIsOn) {
  device_options options;
  options.initial.protection = power_down_protection::on;
  for (const bool header : {true, false}) {
    options.header_after_protection = header;
    on_simulator bench(options);
    ASSERT_TRUE(bench.ask(requests::start()));
    bench.run_for(30 * s);
    EXPECT_EQ(bench.reported, std::vector{notice::protection_found_on});
    EXPECT_TRUE(bench.device.is_scanning());
  }
}

TEST(session_on_simulator, RestartsTheScanAfterAReboot) {
  fault reboot = sim::make_fault(fault_kind::reboot, 20 * s, 1);
  on_simulator bench({}, std::array{reboot});
  ASSERT_TRUE(bench.ask(requests::start()));
  bench.run_for(20 * s);
  EXPECT_TRUE(bench.talk.is_scanning());
  EXPECT_TRUE(bench.device.is_scanning());
}

TEST(session_on_simulator, GivesUpAScanThatBrownsOut) {
  on_simulator bench({}, std::array{sim::make_fault(fault_kind::brown_out)});
  const auto done = bench.ask(requests::start());
  ASSERT_TRUE(done);
  EXPECT_EQ(done->how, verdict::answered);
  bench.run_for(10 * s);
  EXPECT_FALSE(bench.talk.is_scanning());
  ASSERT_FALSE(bench.reported.empty());
  EXPECT_EQ(bench.reported.back(), notice::stalled);
}

TEST(session_on_simulator, StopsAsksAndResumes) {
  on_simulator bench;
  ASSERT_TRUE(bench.ask(requests::start()));
  for (const auto& [name, wanted, holds] : settings()) {
    bench.run_for(100 * ms);
    const auto done = bench.ask(wanted, while_scanning::stop_and_resume);
    ASSERT_TRUE(done);
    EXPECT_EQ(done->how, verdict::answered) << name;
    EXPECT_TRUE(holds(bench.device.settings())) << name;
    EXPECT_TRUE(bench.talk.is_scanning());
  }
  bench.run_for(1 * s);
  EXPECT_TRUE(bench.device.is_scanning());
  EXPECT_TRUE(bench.reported.empty());
  expect_undisturbed(bench);
  expect_idle_after_stop(bench);
}

}  // namespace
}  // namespace g4lidar::test
