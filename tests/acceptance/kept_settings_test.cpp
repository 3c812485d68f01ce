// SPDX-License-Identifier: MIT
// However a run ends, the settings of the lidar are those that it had before.
#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "bench.hpp"
#include "support/test_scale.hpp"

namespace g4_tool::acceptance::test {
namespace {

constexpr std::int64_t s = 1'000 * ms;

/// A lidar whose settings are not the usual ones, and outlive a loss of power.
bench changed(std::string_view word, std::uint16_t chz) {
  bench of(word);
  of.options.scanner.scan_frequency_chz = chz;
  of.options.settings_outlive_power = true;
  of.stream_time = std::chrono::seconds(1);
  return of;
}

const struct {
  std::string_view word;
  std::uint16_t chz;
} lidars[] = {{"g4", 830}, {"t-mini-pro", 1000}, {"tg30", 1210}};

/// Runs it, and expects its settings to be as before.
void expect_kept(bench of, const std::string& when) {
  const sim::device_settings before = sim::device(sim::built_in_world(), of.options).settings();
  const auto all = of.run();
  EXPECT_EQ(of.settings.scan_frequency_chz, before.scan_frequency_chz) << when << '\n'
                                                                       << all_of(all);
  EXPECT_EQ(of.settings.sample_rate, before.sample_rate) << when << '\n' << all_of(all);
  EXPECT_EQ(of.settings.protection, before.protection) << when << '\n' << all_of(all);
  EXPECT_FALSE(of.motor_turns) << when << '\n' << all_of(all);
  EXPECT_EQ(of.lost_settings, "") << when;
}

/// The times at which something is done to a run: in each step, and many times where settings are changed.
std::vector<std::int64_t> times_of(bench of) {
  static_cast<void>(of.run());
  std::vector<std::int64_t> times;
  const std::int64_t begin_ns = of.begun_ns.at(step::protection);
  const std::int64_t setting_ns = of.begun_ns.at(step::frequency);
  const int each = g4lidar::test::scaled(12);
  for (int i = 0; i < each; ++i) {
    times.push_back(begin_ns + (of.end_ns - begin_ns) * i / each);
    times.push_back(setting_ns + 4'000 * ms * i / each);
    times.push_back(begin_ns + 500 * ms * i / each);
  }
  return times;
}

class KeptSettings : public testing::TestWithParam<int> {
 protected:
  KeptSettings() : of_(changed(lidars[GetParam()].word, lidars[GetParam()].chz)) {
    if (GetParam() == 0) {
      of_.options.scanner.sample_rate = g4lidar::sample_rate::khz_8;
      of_.options.initial.protection = power_down_protection::on;
    }
  }
  bench of_;
};

INSTANTIATE_TEST_SUITE_P(Of, KeptSettings, testing::Values(0, 1, 2),
                         [](const auto& of) { return test_name(lidars[of.param].word); });

TEST_P(KeptSettings, AtTheNormalEnd) { expect_kept(of_, "normal"); }

TEST_P(KeptSettings, Cancelled) {
  of_.declines = true;
  for (const std::int64_t at_ns : times_of(of_)) {
    of_.cancelled_at_ns = at_ns;
    expect_kept(of_, "cancelled at " + std::to_string(at_ns));
  }
}

TEST_P(KeptSettings, AnAnswerIsLost) {
  of_.declines = true;
  of_.options.initial.protection = power_down_protection::off;
  bench first = of_;
  static_cast<void>(first.run());
  of_.cancelled_at_ns =
      first.begun_ns.at(step::start_and_stop) + 1 * s;  // no setting is changed later
  for (const std::int64_t at_ns : times_of(of_)) {
    of_.faults = {sim::make_fault(sim::fault_kind::mute, at_ns, 90 * ms)};
    expect_kept(of_, "mute at " + std::to_string(at_ns));
    of_.faults = {sim::make_fault(sim::fault_kind::deaf, at_ns, 90 * ms)};
    expect_kept(of_, "deaf at " + std::to_string(at_ns));
  }
}

TEST_P(KeptSettings, AnswersAreMissingWhileTheyAreSetBack) {
  of_.declines = true;
  bench first = of_;
  static_cast<void>(first.run());
  for (int i = 1; i <= 8; ++i) {
    const std::int64_t at_ns = first.begun_ns.at(step::frequency) + i * 400 * ms;
    of_.cancelled_at_ns = at_ns;
    for (const auto kind : {sim::fault_kind::mute, sim::fault_kind::deaf}) {
      for (const std::int64_t after_ms : {0, 300, 600, 900, 1'200}) {
        const std::int64_t missing_ms = after_ms == 0 ? 4'000 : 700;
        of_.faults = {sim::make_fault(kind, at_ns + after_ms * ms, missing_ms * ms)};
        expect_kept(of_, std::string(sim::name_of(kind)) + " at " + std::to_string(at_ns) + " + " +
                             std::to_string(after_ms));
      }
    }
  }
}

TEST_P(KeptSettings, UnpluggedAndBack) {
  of_.declines = true;
  for (const std::int64_t at_ns : times_of(of_)) {
    of_.faults = {sim::make_fault(sim::fault_kind::unplug, at_ns, 2 * s)};
    bench of = of_;
    const auto all = of.run();
    EXPECT_EQ(of.settings.scan_frequency_chz, of.options.scanner.scan_frequency_chz)
        << at_ns << '\n'
        << all_of(all);
    EXPECT_EQ(of.settings.sample_rate, of.options.scanner.sample_rate) << at_ns;
    EXPECT_EQ(of.lost_settings, "") << at_ns;
    EXPECT_FALSE(of.motor_turns) << at_ns;
  }
}

TEST_P(KeptSettings, AResultCannotBeWritten) {
  for (const step_row& each : step_rows()) {
    of_.throws_after = each.of;
    expect_kept(of_, std::string(each.name));
  }
}

TEST(LostSettings, TheWordsOfTheCommand) {
  bench first = changed("g4", 830);
  first.options.scanner.sample_rate = g4lidar::sample_rate::khz_4;
  static_cast<void>(first.run());
  bench of = changed("g4", 830);
  of.options.scanner.sample_rate = first.options.scanner.sample_rate;
  of.faults = {
      sim::make_fault(sim::fault_kind::unplug, first.begun_ns.at(step::frequency) + 300 * ms)};
  const auto all = of.run();
  EXPECT_EQ(of.lost_settings, "frequency=8.3");
  EXPECT_TRUE(of.failure.has_value());
  EXPECT_EQ(all.back().text, "The connection was lost.");
  of.faults.front().begin_ns = first.begun_ns.at(step::sample_rate) + 2 * s;
  static_cast<void>(of.run());
  EXPECT_EQ(of.lost_settings, "sample_rate=4000");
}

TEST(LostSettings, CancelledWhileItIsUnplugged) {
  bench first = changed("t-mini-pro", 1000);
  first.stays_unplugged = true;
  static_cast<void>(first.run());
  EXPECT_EQ(first.lost_settings, "frequency=10");
  bench of = changed("t-mini-pro", 1000);
  of.cancelled_at_ns = first.begun_ns.at(step::unplug) + 1 * s;
  static_cast<void>(of.run());
  EXPECT_EQ(of.lost_settings, "");
}

TEST(LostSettings, AnotherLidarKeepsItsOwn) {
  bench of = changed("t-mini-pro", 1000);
  of.returns_as = of.options;
  of.returns_as->info.serial_digits[0] = '3';
  static_cast<void>(of.run());
  EXPECT_EQ(of.lost_settings, "frequency=10");
}

TEST(Acceptance, Cancelled_IsReportedOnce) {
  bench of("g4");
  of.cancelled_at_ns = 1'500 * ms;
  const auto all = of.run();
  EXPECT_LT(all.size(), 5U);
  EXPECT_EQ(all.back().text, "Interrupted.");
  EXPECT_EQ(all.back().outcome, finding::not_done);
}

}  // namespace
}  // namespace g4_tool::acceptance::test
