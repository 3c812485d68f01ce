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

TEST(Label, OfProductsThatAreNotSupported) {
  for (const std::string_view label : {"GS1",
                                       "GS2",
                                       "GS5",
                                       "gs-6",
                                       "SDM15",
                                       "sdm 18",
                                       "SDM15B",
                                       "TEA",
                                       "TSA",
                                       "TSA-Pro",
                                       "TIA",
                                       "TIA-H",
                                       "T15",
                                       "t30",
                                       "R3",
                                       "coin-d4",
                                       "COIND4",
                                       "COIN-D4A",
                                       "LDS-03",
                                       "YDLIDAR GS2",
                                       "OS30A",
                                       "os-30a",
                                       "HP60C",
                                       "LD06",
                                       "ld19",
                                       "LD-14P",
                                       "STL-19P",
                                       "stl27l",
                                       "ldlidar",
                                       "LDROBOT LD06",
                                       "RPLIDAR A1",
                                       "rplidar-a1",
                                       "RPLIDAR",
                                       "rplidar_a2m8",
                                       "A1M8",
                                       "A2",
                                       "C1",
                                       "A3M1",
                                       "Slamtec S2",
                                       "sllidar",
                                       "XV-11",
                                       "xv11",
                                       "Neato",
                                       "LDS-01",
                                       "HLS-LFCD2",
                                       "LDS-02",
                                       "Delta-2A",
                                       "3irobotix",
                                       "Camsense X1",
                                       "Hokuyo UST-10LX",
                                       "URG-04LX",
                                       "SICK TiM561",
                                       "MS200",
                                       "Velodyne VLP-16",
                                       "Livox Mid-360",
                                       "TiM561",
                                       "UTM-30LX",
                                       "TFmini",
                                       "TF-Luna",
                                       "N10",
                                       "VLP-16"}) {
    EXPECT_FALSE(why_unsupported(label).empty()) << label;
    EXPECT_EQ(model_named(label), nullptr) << label;
  }
  for (const model& row : models) {
    EXPECT_TRUE(why_unsupported(row.name).empty()) << row.name;
    EXPECT_TRUE(why_unsupported(row.word).empty()) << row.word;
  }
  for (const std::string_view label : {"x44", "", "ydlidar", "GS", "A", "S1", "T1"})
    EXPECT_TRUE(why_unsupported(label).empty()) << label;
}

TEST(Label, HasTheUsualDriverOfItsMaker) {
  for (const auto& [label, driver] :
       {std::pair("LD19", "ldlidar_stl_ros2"), std::pair("RPLIDAR A1", "sllidar_ros2"),
        std::pair("GS2", "YDLidar-SDK"), std::pair("SDM15", "YDLidar-SDK"),
        std::pair("XV-11", "xv_11_driver"), std::pair("LDS-01", "hls_lfcd_lds_driver"),
        std::pair("Delta-2B", "delta_lidar"), std::pair("Camsense X1", "camsense_driver")}) {
    EXPECT_TRUE(why_unsupported(label).ends_with(driver)) << label;
  }
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
