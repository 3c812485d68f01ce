// SPDX-License-Identifier: MIT
// What data sheets and owners state about the speed and the sample rate of models.
#include <gtest/gtest.h>

#include <cmath>

#include "g4lidar/core/model.hpp"

namespace g4lidar {
namespace {

TEST(Owners, SpeedWithoutCommands) {
  for (const model& row : models) {
    EXPECT_EQ(row.frequency.pin.empty(), row.frequency.max_chz != 0) << row.word;
  }
  EXPECT_EQ(model_named("x4")->frequency.pin, "M_SCTR");
  EXPECT_EQ(model_named("x4-pro")->frequency.pin, "M_CTR");
  EXPECT_EQ(model_named("x2")->frequency.pin, "M_CTR or M_SCTP");
  for (const char* const word : {"x3", "x3-pro", "s2", "s2-pro"}) {
    EXPECT_EQ(model_named(word)->frequency.pin, "M_SCTR or M_CTR") << word;
  }
}

TEST(Owners, RatesOfOwners) {
  for (const char* const word : {"x2", "x2l", "x3"}) {
    const model& row = *model_named(word);
    const expected_rate known = expected_rate_of(row, 3000);
    for (const double hz : {2500.0, 2575.0, 3500.0, 3600.0}) {
      EXPECT_TRUE(is_seen_rate(row, hz)) << word;
      EXPECT_LE(std::abs(known.hz / hz - 1.0), known.tolerance) << word << ": " << hz;
    }
    EXPECT_FALSE(is_seen_rate(row, 2400.0));
    EXPECT_FALSE(is_seen_rate(row, 4000.0));
  }
  EXPECT_FALSE(is_seen_rate(g4_model, 9000.0));
  EXPECT_FALSE(is_seen_rate(g4_model, 0.0));
  EXPECT_EQ(expected_rate_of(*model_named("x4"), 5000).tolerance, 0.1);
}

}  // namespace
}  // namespace g4lidar
