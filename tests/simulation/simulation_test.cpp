// SPDX-License-Identifier: MIT
// Some simulation runs of the driver; scripts/ci/simulation has thousands.
#include <gtest/gtest.h>

#include <cstdint>
#include <string_view>

#include "g4lidar/sim/device_options.hpp"
#include "simulation_run.hpp"
#include "soak.hpp"
#include "summary.hpp"
#include "support/test_scale.hpp"

namespace g4lidar::simulation {
namespace {

TEST(SimulationRuns, HoldAllInvariants) {
  summary all;
  for (const int each : test::seeds(12)) {
    const auto seed = static_cast<std::uint64_t>(each);
    const run_parameters parameters = draw_run(seed);
    const run_report report = run_simulation(parameters, false);
    all.add(parameters, report);
    EXPECT_EQ(report.failure, "") << "again: build/release/tests/simulation/simulation_run --seed "
                                  << seed << " --verbose";
  }
  EXPECT_EQ(all.problem(), "");
}

TEST(SimulationRuns, HoldAllInvariantsForEachModel) {
  for (const std::string_view model : sim::model_words()) {
    for (const std::uint64_t seed :
         {std::uint64_t{2}, std::uint64_t{5}}) {  // with faults, and healthy
      const run_report report = run_simulation(draw_run(seed, model), false);
      EXPECT_EQ(report.failure, "")
          << "again: build/release/tests/simulation/simulation_run --seed " << seed << " --model "
          << model << " --verbose";
    }
  }
}

TEST(SimulationRuns, AreTheSameEachTime) {
  const run_parameters parameters = draw_run(5);
  const run_report once = run_simulation(parameters, false);
  const run_report again = run_simulation(parameters, false);
  EXPECT_EQ(once.truths.points, again.truths.points);
  EXPECT_EQ(once.simulated_ns, again.simulated_ns);
  EXPECT_EQ(once.scans, again.scans);
}

TEST(SimulationRuns, GoOnOverAnyNumberOfUnplugs) {
  const soak_report soaked = soak(static_cast<std::uint64_t>(test::scaled(200)));
  EXPECT_EQ(soaked.failure, "");
}

}  // namespace
}  // namespace g4lidar::simulation
