// SPDX-License-Identifier: MIT
// The time for the twist between two revolutions.
#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "g4lidar/motion/twist_estimator.hpp"
#include "motion/driven_lidar.hpp"

namespace {

using namespace g4lidar;

/// Revolutions at 7 Hz (1286 points) of a lidar that drives and turns through a room, each with the one before it.
/// Half of the twists are found without a previous one, as after a start.
void estimate_twist(benchmark::State& state) {
  std::vector<std::vector<point>> pairs;
  for (std::uint32_t seed = 1; seed <= 16; ++seed) {
    test::driven_lidar lidar(test::office(), {.twist = {0.5, 0.0, seed % 2 == 0 ? 1.5 : -0.7}},
                             seed);
    for (int i = 0; i < 3; ++i) pairs.push_back(lidar.revolution());
  }
  twist_estimator estimator;
  std::size_t points = 0;
  for (auto _ : state) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (i % 3 == 0) {
        state.PauseTiming();
        estimator.reset();
        (void)estimator.add(pairs[i]);
        state.ResumeTiming();
      } else {
        benchmark::DoNotOptimize(estimator.add(pairs[i]).twist);
        points += pairs[i].size();
      }
    }
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(points * sizeof(point)));
}
BENCHMARK(estimate_twist)->Arg(1286);

}  // namespace
