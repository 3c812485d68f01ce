// SPDX-License-Identifier: MIT
// The table of models against rows of text that were written from the collected facts about the
// family, not from the table.
#include "g4lidar/core/model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace g4lidar {
namespace {

// One model a line: word; ids; bauds; layout, with the other one behind a slash; correction; way;
// motor; rates in kHz, with their shortest range in cm behind a colon where the rate decides it;
// nominal rate in kHz or ?; whether D0 sets it; limits of the frequency, offset of replies
// and of CT, in 0.01 Hz; divisor of the zero angle; largest LSN; D9; information in CT;
// turn; ranges in mm; bits of intensity.
constexpr const char* expected = R"(
g4;5;230400;r/4;T;two;cmd;4:10 8:26 9:28;9;D0;500-1200;0/0;-;80;yes;??;180;100-16000;0
g4-pro;7;230400;r/4;T;two;cmd;4:10 8:26 9:28;9;D0;500-1200;0/0;-;80;yes;??;180;100-16000;0
g5;20;230400;r/4;T;two;cmd;4:10 8:26 9:28;9;D0;500-1200;0/0;-;80;??;??;180;100-16000;0
f4;1;115200;r/4;T;two;cmd;4;4;-;500-1200;0/0;-;40;no;??;180;120-12000;0
f4-pro;8 4;230400;r/4;T;two;cmd;4 6;4;D0;500-1200;0/0;-;40;yes;??;180;120-12000;0
g1;19;230400;r/4;T;two;cmd;9:28;9;-;500-1200;0/0;4;40;??;??;180;100-16000;0
g2a;14;230400;r/4;T;two;cmd;5;5;-;500-1200;0/0;4;40;??;??;180;100-12000;0
g2c;16;115200;r/4;T;two;cmd;4;4;-;500-1200;0/0;4;40;??;??;180;100-12000;0
g4c;18;115200;r/4;T;two;cmd;4;4;-;500-1200;0/0;-;40;??;??;180;100-12000;0
r2;9;230400;r/4;T;two;cmd;5;5;-;500-1200;0/0;100;40;??;??;180;120-16000;0
g6;13;512000;r/2;T;two;cmd;8:10 16:26 18:28;18;D0;500-1200;0/0;-;40;yes;??;180;100-25000;0
g7;21;512000;r/2;T;two;cmd;8:10 16:26 18:28;18;D0;500-1200;0/0;-;40;yes;??;180;100-25000;0
x4;6;128000;r>>2;T;two;dtr;5;5;-;-;0/0;-;40;no;no;0;120-10000;0
x4-pro;4 6;128000;r>>2;T;one;supply;5;5;-;-;0/0;-;40;no;yes;0;120-10000;0
x2;4 6;115200;r>>2;T;one;dtr;3;3;-;-;0/0;-;40;no;??;0;100-8000;0
x2l;4 6;115200;r>>2;T;one;dtr;3;3;-;-;0/0;-;40;no;??;0;100-8000;0
x3;4 6;115200;r>>2;T;one;dtr;3;3;-;-;0/0;-;40;no;??;0;100-8000;0
x3-pro;4 6;115200;r>>2;T;one;dtr;3 4;?;-;-;0/0;-;40;no;??;0;100-8000;0
s2;4 12;115200 128000;r>>2/i8;T;one;dtr;3 4 5;?;-;-;0/0;-;40;no;yes;0;80-12000;0
s2-pro;4 12;115200 128000;r>>2/i8;T;one;dtr;3 4 5;?;-;-;0/0;-;40;no;yes;0;80-12000;0
s2-intensity;4 12;115200 128000;i8/r>>2;T;one;dtr;3;3;-;-;0/0;-;40;no;yes;0;80-12000;8
s2-pro-intensity;4 12;115200 128000;i8/r>>2;T;one;dtr;3;3;-;-;0/0;-;40;no;yes;0;80-12000;8
s4;4;115200;r>>2;T;two;dtr;4;4;-;-;0/0;-;40;no;??;0;100-8000;0
s4b;4 11;153600;i8;T;two;dtr;4;4;-;-;0/0;-;40;no;??;0;100-8000;8
g2;15;230400;i10;T;two;cmd;5:28;5;-;500-1200;0/0;4;40;??;??;180;100-16000;10
g4b;17;512000;i10;T;two;cmd;10;10;-;500-1200;0/0;-;40;??;??;180;120-16000;10
scl;22;115200;i8;S;one;dtr;3;3;-;-;0/0;-;40;no;??;0;120-8000;8
t-mini;140;230400;i8;-;two;cmd;4;4;-;600-1200;0/0;-;40;??;??;0;50-12000;8
t-mini-pro;150;230400;i8;-;two;cmd;4;4;-;600-1200;0/0;-;40;??;??;0;20-12000;8
t-mini-plus;151;230400;i8;-;two;cmd;4;4;-;600-1200;0/0;-;40;??;??;0;50-12000;8
t-mini-plus-sh;152;230400;i16;-;two;cmd;4;4;-;600-1200;0/0;-;40;??;??;0;50-25000;16
tg15;100;512000;mm;-;two;cmd;10 18 20;?;-;300-1600;-40/300;4;40;yes;??;180;50-30000;0
tg30;101;512000;mm;-;two;cmd;10 18 20;?;-;300-1600;-40/300;4;40;yes;??;180;50-30000;0
tg50;102;512000;mm;-;two;cmd;10 18 20;?;-;300-1600;-40/300;4;40;yes;??;180;50-50000;0
tx8;100;115200;mm;-;one;dtr;4;4;-;-;0/0;-;40;no;??;0;50-8000;0
tx20;100;115200;mm;-;one;dtr;4;4;-;-;0/0;-;40;no;??;0;50-20000;0
)";

std::string text(sample_layout layout) {
  switch (layout) {
    case sample_layout::quarter_mm:
      return "r/4";
    case sample_layout::flagged_mm:
      return "r>>2";
    case sample_layout::half_mm:
      return "r/2";
    case sample_layout::whole_mm:
      return "mm";
    case sample_layout::intensity_10:
      return "i10";
    case sample_layout::intensity_8:
      return "i8";
    case sample_layout::intensity_16:
      return "i16";
  }
  return "";
}

std::string text(presence what) {
  return what == presence::yes ? "yes" : what == presence::no ? "no" : "??";
}

std::string text(correction_kind what) {
  return what == correction_kind::triangle ? "T" : what == correction_kind::scl ? "S" : "-";
}

std::string text(motor_kind what) {
  return what == motor_kind::command ? "cmd" : what == motor_kind::dtr ? "dtr" : "supply";
}

/// `first` and, if it is not 0, `second`.
std::string pair_text(unsigned first, unsigned second) {
  return std::to_string(first) + (second == 0 ? "" : " " + std::to_string(second));
}

std::string rates_text(const sample_rate_list& rates) {
  std::ostringstream out;
  for (const sample_rate_entry& rate : rates.entries) {
    if (rate.hz == 0) break;
    if (&rate != rates.entries.data()) out << ' ';
    out << rate.hz / 1000.0;
    if (rate.shortest_mm != 0) out << ':' << rate.shortest_mm / 10.0;
  }
  out << ';';
  if (rates.nominal_hz == 0) {
    out << '?';
  } else {
    out << rates.nominal_hz / 1000.0;
  }
  out << ';' << (rates.is_settable ? "D0" : "-");
  return out.str();
}

/// `row` in the form of `expected`.
std::string text(const model& row) {
  std::ostringstream out;
  const sample_layout layout = row.samples.layout;
  out << row.word << ';' << pair_text(row.ids[0], row.ids[1]) << ';'
      << pair_text(row.bauds[0], row.bauds[1]) << ';' << text(layout);
  if (row.other_layout != layout) out << '/' << text(row.other_layout);
  out << ';' << text(row.samples.correction) << ';'
      << (row.link == link_kind::two_way ? "two" : "one") << ';' << text(row.motor) << ';'
      << rates_text(row.rates) << ';';
  const frequency_properties& frequency = row.frequency;
  if (frequency.max_chz == 0) {
    out << '-';
  } else {
    out << frequency.min_chz << '-' << frequency.max_chz;
  }
  out << ';' << frequency.reply_offset_chz << '/' << frequency.ct_offset_chz << ';'
      << (row.zero_angle_divisor == 0 ? "-" : std::to_string(row.zero_angle_divisor)) << ';'
      << int{row.samples.max_samples} << ';' << text(row.protection) << ';'
      << text(row.ct_information) << ';' << row.turn_deg << ';' << row.range.min_mm << '-'
      << row.range.max_mm << ';' << intensity_bits(layout);
  return out.str();
}

std::vector<std::string> expected_rows() {
  std::vector<std::string> rows;
  std::istringstream in(expected);
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) rows.push_back(line);
  }
  return rows;
}

TEST(Model, EachRowHasTheKnownValues) {
  const std::vector<std::string> rows = expected_rows();
  EXPECT_EQ(rows.size(), models.size());
  for (const std::string& row : rows) {
    const model* found = model_named(row.substr(0, row.find(';')));
    ASSERT_NE(found, nullptr) << row;
    EXPECT_EQ(text(*found), row);
  }
}

TEST(Model, WithoutANameItIsAG4) {
  EXPECT_EQ(g4_model.word, "g4");
  EXPECT_EQ(g4_model.name, "G4");
}

TEST(Model, ArticleIsThatOfTheSpokenName) {
  const std::set<std::string_view> with_an{
      "f4",     "f4-pro", "r2", "x2",  "x2l", "x3",     "x3-pro",       "x4",
      "x4-pro", "s2",     "s4", "s4b", "scl", "s2-pro", "s2-intensity", "s2-pro-intensity"};
  for (const model& each : models) {
    EXPECT_EQ(article_of(each), with_an.contains(each.word) ? "an" : "a") << each.name;
  }
}

TEST(Model, OtherWordsNameNone) {
  for (const char* word : {"", "g", "g44", "x4pr", "gs2"}) {
    EXPECT_EQ(model_named(word), nullptr) << word;
  }
}

TEST(Model, TheShortestRangeDependsOnTheRateWhereItDoes) {
  EXPECT_EQ(shortest_range_mm(g4_model, 4000), 100);
  EXPECT_EQ(shortest_range_mm(g4_model, 8000), 260);
  EXPECT_EQ(shortest_range_mm(g4_model, 9000), 280);
  EXPECT_EQ(shortest_range_mm(*model_named("g6"), 16000), 260);
  EXPECT_EQ(shortest_range_mm(*model_named("x4"), 5000), 120);
  EXPECT_EQ(shortest_range_mm(*model_named("t-mini-pro"), 4000), 20);
}

// protocol.md: 7.9906 degrees less than the first-level angle; without a correction, and for SCL, at it.
TEST(Model, ANoReturnIsInTheDirectionOfAFarTarget) {
  EXPECT_NEAR(no_return_correction_deg(correction_kind::triangle), -7.9906, 5e-5);
  EXPECT_EQ(no_return_correction_deg(correction_kind::scl), 0.0);
  EXPECT_EQ(no_return_correction_deg(correction_kind::none), 0.0);
}

TEST(Model, OldFirmwareDiffersWhereItDoes) {
  for (const model& each : models) {
    const std::string word(each.word);
    const firmware_difference& old = each.old_firmware;
    if (word == "r2") {
      EXPECT_EQ(old.last_version, 256 + 7);
      EXPECT_EQ(old.layout, sample_layout::quarter_mm);
      EXPECT_EQ(old.zero_angle_divisor, 4);
    } else if (word == "tg15" || word == "tg30" || word == "tg50") {
      EXPECT_EQ(old.last_version, 256 + 2) << word;
      EXPECT_EQ(old.layout, sample_layout::half_mm) << word;
      EXPECT_EQ(old.ct_offset_chz, 0) << word;
      EXPECT_EQ(old.zero_angle_divisor, 4) << word;
    } else {
      EXPECT_EQ(old.last_version, 0) << word;
    }
  }
}

device_information reporting(std::uint8_t id, int major, int minor) {
  return {id, static_cast<std::uint8_t>(major), static_cast<std::uint8_t>(minor), 1, {}};
}

TEST(Model, AnOldFirmwareHasARecordOfItsOwn) {
  const model& tg15 = *model_named("tg15");
  for (const auto& [major, minor] : {std::pair{0, 9}, {1, 0}, {1, 2}}) {
    const model& old = with_firmware(tg15, reporting(100, major, minor));
    EXPECT_EQ(old.word, "tg15");
    EXPECT_EQ(old.samples.layout, sample_layout::half_mm) << major << "." << minor;
    EXPECT_EQ(true_frequency_chz(old, 700), 700);
    EXPECT_EQ(old.frequency.reply_offset_chz, -40) << "as the new one";
    EXPECT_EQ(&with_firmware(old, reporting(100, 3, 2)), &old) << "only of the table";
  }
  for (const auto& [major, minor] : {std::pair{1, 3}, {2, 0}, {3, 2}}) {
    EXPECT_EQ(&with_firmware(tg15, reporting(100, major, minor)), &tg15) << major << "." << minor;
  }
  EXPECT_EQ(&with_firmware(tg15, reporting(101, 1, 2)), &tg15) << "another model";
  EXPECT_EQ(&with_firmware(tg15, {}), &tg15) << "nothing is known";
  const model& r2 = *model_named("r2");
  EXPECT_EQ(with_firmware(r2, reporting(9, 1, 7)).zero_angle_divisor, 4);
  EXPECT_EQ(with_firmware(r2, reporting(9, 1, 8)).zero_angle_divisor, 100);
  EXPECT_EQ(&with_firmware(g4_model, reporting(5, 0, 1)), &g4_model);
}

// Of a TG code 3 means 20 kHz and code 4 10 kHz, beside the places of the rates.
TEST(Model, CodesOfSampleRates) {
  for (const model& each : models) {
    const bool is_tg = each.word.starts_with("tg");
    EXPECT_EQ(rate_hz_of_code(each, 3), is_tg ? 20'000U : 0U) << each.word;
    EXPECT_EQ(rate_hz_of_code(each, 4), is_tg ? 10'000U : 0U) << each.word;
    EXPECT_EQ(rate_hz_of_code(each, 5), 0U) << each.word;
    EXPECT_EQ(rate_hz_of_code(each, 255), 0U) << each.word;
  }
  EXPECT_EQ(rate_hz_of_code(*model_named("tg50"), 1), 18'000U);
}

TEST(Model, TheRateOfADeviceThatAnswersIsTrueWithinFourPercent) {
  const expected_rate rate = expected_rate_of(*model_named("g6"), 16'000);
  EXPECT_EQ(rate.hz, 16'000.0);
  EXPECT_EQ(rate.tolerance, 0.04);
}

// A device that cannot be asked may have a firmware with another oscillator or another number.
TEST(Model, TheRateOfADeviceThatCannotBeAskedIsTrueWithinTenPercent) {
  const expected_rate rate = expected_rate_of(*model_named("x4"), 5000);
  EXPECT_EQ(rate.hz, 5000.0);
  EXPECT_EQ(rate.tolerance, 0.1);
}

TEST(Model, ARateThatIsNotKnownIsBetweenThoseOfTheTable) {
  struct expectation {
    const char* word;
    double lowest_hz, highest_hz;
  };
  for (const auto& [word, lowest_hz, highest_hz] :
       {expectation{"tg30", 9000, 22'000}, {"s2", 2700, 5500}, {"x3-pro", 2700, 4400}}) {
    const expected_rate rate = expected_rate_of(*model_named(word), 1);
    EXPECT_NEAR((1.0 - rate.tolerance) / rate.hz, 1.0 / highest_hz, 1e-12) << word;
    EXPECT_NEAR((1.0 + rate.tolerance) / rate.hz, 1.0 / lowest_hz, 1e-12) << word;
    EXPECT_LT(rate.tolerance, 0.5) << word;
  }
}

TEST(Model, AScanHasRoomForAMotorThatSpinsUp) {
  EXPECT_EQ(largest_scan(g4_model), 8192U);
  EXPECT_EQ(largest_scan(*model_named("x2")), 8192U);
  EXPECT_EQ(largest_scan(*model_named("g6")), 14'400U);    // 4 x 18 kHz at 5 Hz
  EXPECT_EQ(largest_scan(*model_named("tg30")), 26'666U);  // 4 x 20 kHz at 3 Hz
}

TEST(Model, TheUnitOfARange) {
  EXPECT_EQ(range_units_per_mm(sample_layout::quarter_mm), 4);
  EXPECT_EQ(range_units_per_mm(sample_layout::flagged_mm), 4);
  EXPECT_EQ(range_units_per_mm(sample_layout::half_mm), 2);
  EXPECT_EQ(range_units_per_mm(sample_layout::whole_mm), 1);
  EXPECT_EQ(range_units_per_mm(sample_layout::intensity_10), 4);
  EXPECT_EQ(range_units_per_mm(sample_layout::intensity_8), 4);
  EXPECT_EQ(range_units_per_mm(sample_layout::intensity_16), 1);
}

TEST(Model, SizesOfSamples) {
  EXPECT_EQ(sample_size(sample_layout::quarter_mm), 2U);
  EXPECT_EQ(sample_size(sample_layout::flagged_mm), 2U);
  EXPECT_EQ(sample_size(sample_layout::half_mm), 2U);
  EXPECT_EQ(sample_size(sample_layout::whole_mm), 2U);
  EXPECT_EQ(sample_size(sample_layout::intensity_10), 3U);
  EXPECT_EQ(sample_size(sample_layout::intensity_8), 3U);
  EXPECT_EQ(sample_size(sample_layout::intensity_16), 4U);
}

// A line of the family sends its samples in time: 10 bits a byte, a header of 10 bytes with 40
// samples, at the fastest rate with each baud rate. (Not those whose rate depends on the baud rate.)
TEST(Model, TheSamplesFitIntoTheBaudRate) {
  for (const model& each : models) {
    std::uint32_t fastest = 0;
    for (const sample_rate_entry& rate : each.rates.entries) fastest = std::max(fastest, rate.hz);
    const double bytes =
        fastest * (static_cast<double>(sample_size(each.samples.layout)) + 10.0 / 40);
    EXPECT_LT(bytes, std::max(each.bauds[0], each.bauds[1]) / 10.0) << each.word;
  }
}

}  // namespace
}  // namespace g4lidar
