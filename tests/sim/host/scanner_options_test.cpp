// SPDX-License-Identifier: MIT
// The valid options of the simulated head.
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "g4lidar/sim/scanner.hpp"

namespace {

using namespace g4lidar;

TEST(SimScanner, ImpossibleOptions_AreNamed) {
  const auto problem = [](auto&& change) {
    sim::scanner_options options;
    change(options);
    return std::string(sim::problem_with(options));
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(problem([](auto&) {}), "");
  EXPECT_NE(problem([](auto& o) { o.scan_frequency_chz = 499; }), "");
  EXPECT_NE(problem([](auto& o) { o.scan_frequency_chz = 1201; }), "");
  EXPECT_NE(problem([](auto& o) { o.samples_per_packet = 0; }), "");
  EXPECT_NE(problem([](auto& o) { o.samples_per_packet = 81; }), "");
  for (const double degrees : {-0.001, 360.0, nan}) {
    EXPECT_NE(problem([=](auto& o) { o.index_deg = degrees; }), "");
    EXPECT_NE(problem([=](auto& o) { o.start_deg = degrees; }), "");
  }
  EXPECT_NE(problem([](auto& o) { o.min_range_mm = 0.0; }), "");
  EXPECT_NE(problem([](auto& o) { o.min_range_mm = 16'001.0; }), "");
  EXPECT_NE(problem([](auto& o) { o.max_range_mm = 16'384.0; }), "");
  for (const double ratio : {-0.1, 1.1, nan}) {
    EXPECT_NE(problem([=](auto& o) { o.noise_ratio = ratio; }), "");
    EXPECT_NE(problem([=](auto& o) { o.dropout_ratio = ratio; }), "");
  }
  EXPECT_NE(problem([](auto& o) { o.noise_mm = -1.0; }), "");
  EXPECT_NE(problem([](auto& o) { o.noise_mm = nan; }), "");
}

}  // namespace
