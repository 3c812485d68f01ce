// SPDX-License-Identifier: MIT
// The values of settings from text: what can be set, and what an error states.
#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "g4lidar/options/lidar_parameters.hpp"
#include "g4lidar/options/option_table.hpp"

namespace g4lidar {
namespace {

const setting_info& row(std::string_view name) {
  return *std::ranges::find(all_settings(), name, &setting_info::name);
}

TEST(SettingText, IsAWordOrANumberOfTheTable) {
  EXPECT_EQ(value_in(row("sample_rate"), "9k"), answer(sample_rate::khz_9));
  EXPECT_EQ(value_in(row("sample_rate"), "18000"), answer(sample_rate{18'000}));
  EXPECT_EQ(value_in(row("frequency"), "7.5"), answer(scan_frequency{750}));
  EXPECT_EQ(value_in(row("frequency"), "16"), answer(scan_frequency{1600}));
  EXPECT_EQ(value_in(row("direction"), "ccw"), answer(motor_direction::counter_clockwise));
  EXPECT_EQ(value_in(row("constant"), "off"), answer(constant_frequency::off));
  EXPECT_EQ(value_in(row("idle"), "on"), answer(low_power::on));
  EXPECT_EQ(value_in(row("protection"), "on"), answer(power_down_protection::on));
}

TEST(SettingText, AnErrorStatesWhatIsPossible) {
  const auto why = [](std::string_view name, std::string_view text) {
    const auto given = value_in(row(name), text);
    if (given) return std::string("none");
    EXPECT_EQ(given.error().doing(), task::configuring);
    EXPECT_EQ(given.error(), problem::bad_option);
    return std::string(given.error().subject());
  };
  EXPECT_EQ(why("frequency", "16.1"), "frequency: '16.1' is not in the range 3 to 16 Hz");
  EXPECT_EQ(why("frequency", "nan"), "frequency: 'nan' is not in the range 3 to 16 Hz");
  EXPECT_EQ(why("frequency", "7 "), "frequency: '7 ' is not in the range 3 to 16 Hz");
  EXPECT_EQ(why("frequency", "7.55"), "frequency: '7.55' is not a multiple of 0.1 Hz");
  EXPECT_EQ(why("sample_rate", "7k"),
            "sample_rate: '7k' is not one of 4k, 6k, 8k, 9k, 10k, 16k, 18k, 20k Hz");
  EXPECT_EQ(why("direction", "1"), "direction: '1' is not one of cw, ccw");
  EXPECT_EQ(why("idle", ""), "idle: '' is not one of off, on");
  EXPECT_THAT(why("sample_rate", std::string(500, '9')), ::testing::EndsWith("18k, 20k Hz"));
}

TEST(SettingText, AnErrorOfAKnownModelHasItsLimits) {
  const auto why = [](std::string_view name, std::string_view text, const char* word) {
    const auto given = value_in(row(name), text, model_named(word));
    return given ? std::string("none") : std::string(given.error().subject());
  };
  EXPECT_EQ(why("frequency", "40", "g4"), "frequency: '40' is not in the range 5 to 12 Hz of a G4");
  EXPECT_EQ(why("frequency", "3", "g4"), "frequency: '3' is not in the range 5 to 12 Hz of a G4");
  EXPECT_EQ(why("frequency", "3", "tg15"), "none");
  EXPECT_EQ(why("sample_rate", "16k", "g4"),
            "sample_rate: '16k' is not one of 4k, 8k, 9k Hz of a G4");
  EXPECT_EQ(why("sample_rate", "16k", "g6"), "none");
  EXPECT_EQ(why("direction", "up", "g4"), "direction: 'up' is not one of cw, ccw of a G4");
  EXPECT_EQ(why("frequency", "40", "x2"), "frequency: '40' is not in the range 3 to 16 Hz")
      << "it has no such setting";
}

TEST(SettingText, WordsAreShownAsOneShortLine) {
  const auto given = value_in(row("idle"), "a\nb\x1b[2J" + std::string(300'000, 'x'));
  ASSERT_FALSE(given);
  EXPECT_EQ(given.error().subject(),
            R"(idle: 'a\x0Ab\x1B[2Jxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx...' is not one of off, on)");
}

TEST(SettingText, AValueOfAParameterIsReadAsItsText) {
  EXPECT_EQ(answer_of(row("frequency"), std::int64_t{6}), answer(scan_frequency{600}));
  EXPECT_EQ(answer_of(row("frequency"), 9.3), answer(scan_frequency{930}));
  EXPECT_EQ(answer_of(row("sample_rate"), std::int64_t{4000}), answer(sample_rate::khz_4));
  EXPECT_EQ(answer_of(row("idle"), true), answer(low_power::on));
  EXPECT_FALSE(answer_of(row("frequency"), {})) << "not known";
  EXPECT_FALSE(answer_of(row("frequency"), true));
}

}  // namespace
}  // namespace g4lidar
