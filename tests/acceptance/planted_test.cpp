// SPDX-License-Identifier: MIT
// The kit reports each planted difference, and each field of the table has one.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cctype>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "planted.hpp"

namespace g4_tool::acceptance::test {
namespace {

using enum finding;
using enum step;

class Planted : public testing::TestWithParam<std::size_t> {};

TEST_P(Planted, IsFound) {
  const planted& made = all_planted()[GetParam()];
  bench with(made.word);
  made.plant(with);
  const auto all = with.run();
  ASSERT_EQ(all.size(), step_count) << all_of(all);
  const step_result& found = at(all, made.found_by);
  EXPECT_EQ(name_of(found.outcome), name_of(differs)) << all_of(all);
  EXPECT_NE(found.text.find(made.text), std::string::npos) << all_of(all);
}

INSTANTIATE_TEST_SUITE_P(Difference, Planted, testing::Range(std::size_t{0}, all_planted().size()),
                         [](const auto& of) {
                           const planted& made = all_planted()[of.param];
                           std::string name = std::to_string(of.param) + "_" + test_name(made.word);
                           for (const char each : made.field)
                             name +=
                                 std::isalnum(static_cast<unsigned char>(each)) != 0 ? each : '_';
                           return name;
                         });

// ---- each field of the record has one ----

/// All fields of the record. A field that is added does not compile here: then it wants a row above.
std::vector<std::string> fields_of(const model& row) {
  [[maybe_unused]] const auto& [word, name, ids, bauds, samples_of, link, motor, rates_of,
                                frequency_of, range, turn_deg, zero_angle_divisor, protection_of,
                                ct, has_motor_settings, other_layout, old, has_pitch, usual] = row;
  [[maybe_unused]] const auto& [layout, correction, max_samples, has_angle_replies,
                                largest_byte_reply] = samples_of;
  [[maybe_unused]] const auto& [entries, nominal_hz, is_settable, further_codes_hz, least_seen_hz,
                                most_seen_hz] = rates_of;
  [[maybe_unused]] const auto& [hz, shortest_mm] = entries.front();
  [[maybe_unused]] const auto& [min_chz, max_chz, reply_offset_chz, ct_offset_chz, pin] =
      frequency_of;
  [[maybe_unused]] const auto& [min_mm, max_mm] = range;
  [[maybe_unused]] const auto& [last_version, old_layout, old_ct_offset, old_divisor] = old;
  std::vector<std::string> all{"word", "name"};
  const auto add_each = [&all](std::string_view array, std::size_t count,
                               std::string_view member = "") {
    for (std::size_t i = 0; i < count; ++i)
      all.push_back(fmt::format("{}[{}]{}", array, i, member));
  };
  add_each("ids", ids.size());
  add_each("bauds", bauds.size());
  for (const std::string_view each :
       {"layout", "correction", "max_samples", "has_angle_replies", "largest_byte_reply"})
    all.push_back(fmt::format("samples.{}", each));
  add_each("rates.entries", entries.size(), ".hz");
  add_each("rates.entries", entries.size(), ".shortest_mm");
  add_each("rates.further_codes_hz", further_codes_hz.size());
  for (const char* each : {"link",
                           "motor",
                           "rates.nominal_hz",
                           "rates.is_settable",
                           "rates.least_seen_hz",
                           "rates.most_seen_hz",
                           "frequency.min_chz",
                           "frequency.max_chz",
                           "frequency.reply_offset_chz",
                           "frequency.ct_offset_chz",
                           "frequency.pin",
                           "range.min_mm",
                           "range.max_mm",
                           "turn_deg",
                           "zero_angle_divisor",
                           "protection",
                           "ct_information",
                           "has_motor_settings",
                           "other_layout",
                           "old_firmware.last_version",
                           "old_firmware.layout",
                           "old_firmware.ct_offset_chz",
                           "old_firmware.zero_angle_divisor",
                           "has_pitch",
                           "usual"})
    all.emplace_back(each);
  return all;
}

TEST(PlantedDifferences, EachFieldOfTheRecordHasOne) {
  // What a program calls it, which one is taken where bytes fit several, and a text about its plug: nothing that a lidar
  // sends.
  std::set<std::string> had{"word", "name", "usual", "frequency.pin"};
  for (const planted& each : all_planted()) had.insert(std::string(each.field));
  for (const std::string& each : fields_of(g4_model)) EXPECT_TRUE(had.contains(each)) << each;
}

TEST(PlantedDifferences, EachStepHasOneWithAnotherModelThanAG4) {
  std::set<step> found;
  for (const planted& each : all_planted())
    if (each.word != "g4") found.insert(each.found_by);
  EXPECT_EQ(found.size(), step_count - 1);  // whether there are time packets is in no table
}

// What is expected of a one-way lidar whose rate cannot be asked is less exact.
TEST(PlantedDifferences, ARateWithinTheToleranceOfTheModelIsNone) {
  for (const auto& [word, ratio] :
       {std::pair{"g4", 1.035}, {"g4", 0.97}, {"x2", 1.06}, {"x2", 0.94}}) {
    bench of(word);
    of.options.scanner.sample_rate_ratio = ratio;
    const auto all = of.run();
    EXPECT_NE(at(all, stream).outcome, differs) << word << ratio << all_of(all);
  }
}

}  // namespace
}  // namespace g4_tool::acceptance::test
