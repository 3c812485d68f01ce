// SPDX-License-Identifier: MIT
// Some lives of the driver; scripts/ci/lives lives thousands.
#include <gtest/gtest.h>

#include "life.hpp"
#include "soak.hpp"
#include "summary.hpp"
#include "support/test_scale.hpp"

namespace g4lidar::lives {
namespace {

TEST(Lives, GoWell) {
  summary all;
  const auto count = static_cast<std::uint64_t>(test::scaled(12));
  for (std::uint64_t seed = 1; seed <= count; ++seed) {
    const life_plan plan = draw_life(seed);
    const life_report lived = live(plan, false);
    all.add(plan, lived);
    EXPECT_EQ(lived.failure, "") << "again: build/release/tests/lives/lives --seed " << seed
                                 << " --verbose";
  }
  EXPECT_EQ(all.problem(), "");
}

TEST(Lives, AreTheSameEachTime) {
  const life_plan plan = draw_life(5);
  const life_report once = live(plan, false);
  const life_report again = live(plan, false);
  EXPECT_EQ(once.truths.points, again.truths.points);
  EXPECT_EQ(once.lived_ns, again.lived_ns);
  EXPECT_EQ(once.scans, again.scans);
}

TEST(Lives, GoOnOverAnyNumberOfUnplugs) {
  const soak_report soaked = soak(static_cast<std::uint64_t>(test::scaled(200)));
  EXPECT_EQ(soaked.failure, "");
}

}  // namespace
}  // namespace g4lidar::lives
