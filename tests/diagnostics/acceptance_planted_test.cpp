// SPDX-License-Identifier: MIT
// Differences from the table of models that are planted in simulated lidars: each step finds its own, on
// models for which it matters.
#include <gtest/gtest.h>

#include <functional>
#include <initializer_list>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "acceptance_bench.hpp"

namespace g4lidar::test {
namespace {

using bench = acceptance_bench;
using enum acceptance_step;
using enum acceptance_verdict;

/// A lidar of the model `word` with a difference, and what a step finds.
struct planted {
  std::string_view name;
  std::string_view word;
  std::function<void(bench&)> plant;
  acceptance_step found_by;
  std::string_view text;
  acceptance_verdict verdict = differs;
};

/// The lidar is one of another model.
auto is_really(std::string_view word) {
  return [word](bench& of) { of.options = bench(word).options; };
}
auto turned(bool is_turned) {
  return [is_turned](bench& of) { of.options.scanner.format.is_turned = is_turned; };
}
auto driven_by(sim::drive what) {
  return [what](bench& of) { of.options.driven_by = what; };
}
/// Samples of the same size, whose two lower bits are something else.
auto samples(std::uint8_t units_per_mm, sim::lower_bits lower) {
  return [=](bench& of) {
    of.options.scanner.format.code.units_per_mm = units_per_mm;
    of.options.scanner.format.code.lower = lower;
  };
}
/// It does not have this command.
auto without(std::uint8_t code) {
  return [code](bench& of) {
    sim::command_set fewer{};
    for (unsigned each = 0; each < 256; ++each) {
      const auto one = static_cast<std::uint8_t>(each);
      if (one != code && of.options.commands.has(one)) fewer.add(one);
    }
    of.options.commands = fewer;
  };
}
/// Another lidar is plugged in again.
auto returns_as(std::string_view word) {
  return [word](bench& of) {
    of.returns_as = bench(word).options;
    of.returns_as->info.serial_digits[0] = '3';
  };
}

const std::vector<planted> differences{
    {"ABridgeWithFewRates", "tg30", [](bench& of) { of.set_baud = 500'000; }, bridge,
     "another baud rate"},
    {"ATwoWayX2", "x2", is_really("s4"), listening, "sends no packet"},
    {"AScanningX4InsteadOfAnX4Pro", "x4-pro",
     [](bench& of) {
       of.options = bench("x4").options;
       of.options.dtr_starts_by = sim::dtr_start::level;
       of.scans = true;
     },
     listening, "It obeys a stop"},
    {"AnX2ThatAnswers", "x2", is_really("s4"), identity, "as a two-way lidar"},
    {"ATMiniWithAnotherNumber", "t-mini-pro", [](bench& of) { of.options.info.model = 9; },
     identity, "not that of the model"},
    {"AnX4ThatIsAnX4Pro", "x4", is_really("x4-pro"), identity, "does not answer"},
    {"AG4WithoutHealth", "g4",
     [](bench& of) { of.options.answers_health_91 = of.options.answers_health_92 = false; },
     queries, "The health is not that"},
    {"ATgWithoutAnOffset", "tg30", without(0x93), queries, "zero_angle_93 is not answered"},
    {"AnX4WithAFrequency", "x4", [](bench& of) { of.options.commands.add(0x0D); }, queries,
     "frequency_0d is answered, although"},
    {"ATgWithoutProtection", "tg30", without(0xD9), acceptance_step::protection,
     "D9 is not answered"},
    {"AG6WithoutProtection", "g6", without(0xD9), acceptance_step::protection,
     "D9 is not answered"},
    {"ATMiniThatEndsAt9Hz", "t-mini-pro",
     [](bench& of) {
       of.options.scanner.scan_frequency_chz = 800;
       of.options.highest_frequency_chz = 900;
     },
     acceptance_step::frequency, "The limits are not"},
    {"AG6With10kHz", "g6",
     [](bench& of) { of.options.scanner.format.rates_hz = {10'000, 16'000, 18'000}; },
     acceptance_step::sample_rate, "The rate behind code 0"},
    {"AnX4WithoutItsSecondPlug", "x4", [](bench& of) { of.options.motor_has_power = false; },
     start_and_stop, "second plug"},
    {"ATMiniThatDoesNotStop", "t-mini-pro", without(0x65), start_and_stop,
     "does not stop after 65"},
    {"AnX4WithACommandedMotor", "x4", driven_by(sim::drive::commands), dtr, "does not stop it"},
    {"AnX2OnItsSupply", "x2", driven_by(sim::drive::power), dtr, "does not stop it"},
    {"AnX4ProWithDtr", "x4-pro",
     [](bench& of) {
       of.options.driven_by = sim::drive::dtr_line;
       of.options.dtr_starts_by = sim::dtr_start::level;
     },
     dtr, "DTR stops it"},
    {"AnX2WithTheRateOfAnX3Pro", "x2",
     [](bench& of) {
       of.options.scanner.format.rates_hz[0] = 4'000;
       of.options.scanner.sample_rate = static_cast<g4lidar::sample_rate>(4'000);
     },
     stream, "The sample rate is none"},
    {"ATgWhoseZeroPacketsAreRight", "tg30",
     [](bench& of) { of.options.scanner.format.ct_offset_dhz = 0; }, stream, "another offset"},
    {"AG2WithTwoByteSamples", "g2",
     [](bench& of) { of.options.scanner.format.code = bench("g2a").options.scanner.format.code; },
     stream, "No packet came"},
    {"AnX4WithRangeInTheBits", "x4", samples(4, sim::lower_bits::range), sample_bits, "are range"},
    {"ATMiniWithIntensityOf10Bits", "t-mini-pro", samples(1, sim::lower_bits::intensity),
     sample_bits, "are intensity"},
    {"AG2WithFlags", "g2", samples(1, sim::lower_bits::flags), sample_bits, "are flags"},
    {"AnX4ProWithoutInformation", "x4-pro", [](bench& of) { of.options.ct_information = false; },
     acceptance_step::ct_information, "contain no information"},
    {"AnX4WithInformation", "x4",
     [](bench& of) {
       of.options.ct_information = of.options.ct_crc = of.options.stray_before_zero = true;
     },
     acceptance_step::ct_information, "The CT bytes contain information."},
    {"AnX4ProWithTimePackets", "x4-pro", [](bench& of) { of.options.time_packet_ns = 100'000'000; },
     acceptance_step::time_packets, "It sends time packets.", observed},
    {"ATMiniWithTimePackets", "t-mini-pro",
     [](bench& of) { of.options.time_packet_ns = 100'000'000; }, acceptance_step::time_packets,
     "It sends time packets.", observed},
    {"ATurnedTMini", "t-mini-pro", turned(true), near_target, "from straight ahead"},
    {"ATurnedX4", "x4", turned(true), near_target, "from straight ahead"},
    {"AG2ThatIsNotTurned", "g2", turned(false), near_target, "from straight ahead"},
    {"ATgThatIsNotTurned", "tg30", turned(false), near_target, "from straight ahead"},
    {"ATgOfHalfMillimetres", "tg30",
     [](bench& of) { of.options.scanner.format.code.units_per_mm = 2; }, near_target,
     "not that of the target"},
    {"ATxOfQuarterMillimetres", "tx8",
     [](bench& of) { of.options.scanner.format.code.units_per_mm = 4; }, far_target,
     "not that of the target"},
    {"AnX2ThatDoesNotComeBack", "x2", [](bench& of) { of.stays_unplugged = true; }, unplug,
     "did not come back"},
    {"AnX2ThatComesBackSilent", "x2", returns_as("s4"), unplug, "It does not send again"},
    {"AnX4OfAnotherNumber", "x4", returns_as("x4"), unplug, "Another lidar"},
    {"ATgOfAnotherNumber", "tg30", returns_as("tg30"), unplug, "Another lidar"},
};

class Planted : public testing::TestWithParam<planted> {};

TEST_P(Planted, IsFound) {
  bench with(GetParam().word);
  GetParam().plant(with);
  const auto all = with.run();
  const acceptance_result& found = at(all, GetParam().found_by);
  EXPECT_EQ(name_of(found.outcome), name_of(GetParam().verdict)) << all_of(all);
  EXPECT_NE(found.text.find(GetParam().text), std::string::npos) << found.text << all_of(all);

  bench healthy(GetParam().word);
  const auto right = healthy.run();
  const acceptance_result& same = at(right, GetParam().found_by);
  EXPECT_EQ(same.text.find(GetParam().text), std::string::npos) << same.text;
  EXPECT_NE(name_of(same.outcome), name_of(differs)) << same.text;
}

INSTANTIATE_TEST_SUITE_P(Difference, Planted, testing::ValuesIn(differences),
                         [](const auto& of) { return std::string(of.param.name); });

TEST(PlantedDifferences, EachStepHasOneWithAnotherModelThanAG4) {
  std::set<acceptance_step> found;
  for (const planted& each : differences) {
    if (each.word != "g4") found.insert(each.found_by);
  }
  EXPECT_EQ(found.size(), acceptance_step_count);
}

}  // namespace
}  // namespace g4lidar::test
