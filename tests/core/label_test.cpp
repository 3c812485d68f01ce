// SPDX-License-Identifier: MIT
// The names by which people call models, in their spellings.
#include "g4lidar/core/label.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <utility>

#include "g4lidar/core/model.hpp"
#include "g4lidar/sim/device_options.hpp"

namespace g4lidar {
namespace {

/// `name` with `to` in the place of each blank and hyphen; 0: without them.
std::string joined(std::string_view name, char to) {
  std::string made;
  for (const char c : name) {
    const bool is_gap = c == ' ' || c == '-';
    if (!is_gap) made += c;
    if (is_gap && to != 0) made += to;
  }
  return made;
}

std::string upper(std::string text) {
  for (char& c : text) {
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  }
  return text;
}

TEST(Label, NamesEachModelInAnySpelling) {
  for (const model& row : models) {
    const std::string name(row.name);
    for (const std::string& each :
         {std::string(row.word), name, upper(name), joined(name, 0), upper(joined(name, 0)),
          joined(name, '_'), joined(name, '-'), "YDLIDAR " + name,
          "ydlidar-" + std::string(row.word), " " + name + " "}) {
      EXPECT_EQ(model_named(each), &row) << each;
      sim::device_options simulated;
      EXPECT_TRUE(sim::use_model(simulated, each)) << each;
      EXPECT_EQ(simulated.model, row.word) << each;
    }
  }
}

TEST(Label, OfReports) {
  for (const auto& [label, word] :
       {std::pair("X4", "x4"), std::pair("TminiPlus", "t-mini-plus"),
        std::pair("T-mini Pro", "t-mini-pro"), std::pair("x4pro", "x4-pro"), std::pair("G2B", "g2"),
        std::pair("X2N", "x2"), std::pair("SCL", "scl"), std::pair("S2PRO", "s2-pro"),
        std::pair("YDLIDAR X4", "x4"), std::pair("Tmini_Plus SH", "t-mini-plus-sh")}) {
    ASSERT_NE(model_named(label), nullptr) << label;
    EXPECT_EQ(model_named(label)->word, word) << label;
  }
}

TEST(Label, OfNothing) {
  using std::string_view_literals::operator""sv;
  for (const std::string_view label : {""sv, " "sv, "-"sv, "ydlidar"sv, "x44"sv, "x"sv, "x4\0"sv,
                                       "x4\0pro"sv, "x4 pro max"sv, "G2 S"sv, "GS2"sv, "4"sv}) {
    EXPECT_EQ(model_named(label), nullptr) << label;
  }
}

TEST(Label, OfProductsWithAnotherProtocol) {
  for (const std::string_view label :
       {"GS1", "GS2", "GS5", "gs-6", "SDM15", "sdm 18", "TEA", "TSA", "TSA-Pro", "TIA", "T15",
        "t30", "R3", "coin-d4", "COIND4", "LDS-03", "YDLIDAR GS2"}) {
    EXPECT_FALSE(other_product(label).empty()) << label;
    EXPECT_EQ(model_named(label), nullptr) << label;
  }
  for (const model& row : models) EXPECT_TRUE(other_product(row.name).empty()) << row.name;
  EXPECT_TRUE(other_product("x44").empty());
  EXPECT_TRUE(other_product("").empty());
}

TEST(Label, OfNumbers) {
  EXPECT_EQ(other_product(52), "GS2");
  EXPECT_EQ(other_product(200), "T15 or T30");
  EXPECT_EQ(other_product(211), "TIA");
  EXPECT_EQ(other_product(0), "");
  EXPECT_EQ(other_product(6), "");
}

}  // namespace
}  // namespace g4lidar
