// SPDX-License-Identifier: MIT
// The window of earliest arrivals: what it keeps, and which part of it is used for the line.
#include "g4lidar/core/clock/arrival_window.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "support/arrival_model.hpp"

namespace g4lidar {
namespace {

constexpr double period = 100e3;  // 10 kHz
constexpr arrival_window::slopes any{-0.05, 0.05};

/// Samples 0, 10, ... of a line that begins at 1 s, each late by `late_ns(sample)`.
template <class Late>
sampling_line line_under(std::int64_t samples, double mean_late_ns, Late late_ns) {
  arrival_window window(period);
  window.clear();
  for (std::int64_t k = 0; k < samples; k += 10) {
    window.add({k, 1'000'000'000 + k * 100'000 + static_cast<std::int64_t>(late_ns(k))}, period);
  }
  return window.fit(any, mean_late_ns);
}
double error_at(const sampling_line& line, std::int64_t k) {
  return static_cast<double>(line.at(k) - 1'000'000'000 - k * 100'000);
}

TEST(ArrivalWindow, KeepsTheEarliestOfABlock) {
  // One in 97 is in time; in blocks of 200 samples and more that is nearly every one.
  const auto late = [](std::int64_t k) { return k / 10 % 97 == 0 ? 0.0 : 4e6; };
  EXPECT_NEAR(error_at(line_under(200'000, 1e6, late), 200'000), 0.0, 100e3);
}

TEST(ArrivalWindow, MergedBlocks_KeepTheEarlierArrival) {
  // Every second block of 20 ms is early; the 65th block has merged the 64 before it to 32.
  for (const int odd : {0, 1}) {
    const auto late = [odd](std::int64_t k) { return k / 200 % 2 == odd ? 0.0 : 8e6; };
    const sampling_line line = line_under(12'900, 1e6, late);
    EXPECT_NEAR(error_at(line, 12'900), 0.0, 500e3) << odd;
    EXPECT_LT(line.mean_delay_ns, 1e6) << odd;
  }
}

TEST(ArrivalWindow, ForgetsAfterTwentySeconds) {
  arrival_window window(period);
  window.clear();
  EXPECT_EQ(window.span_ns(), 0.0);
  for (std::int64_t k = 0; k < 400'000; k += 10) window.add({k, k * 100'000}, period);
  EXPECT_GT(window.span_ns(), 19e9);
  EXPECT_LT(window.span_ns(), 21e9);
  window.clear();
  EXPECT_EQ(window.span_ns(), 0.0);
}

TEST(ArrivalWindow, LargeDelays_UseTheWholeWindow) {
  arrivals::model dice(arrivals::options{.seed = 3});
  const auto late = [&](std::int64_t) { return dice.exponential(20e6); };
  const sampling_line line = line_under(160'000, 20e6, late);
  EXPECT_NEAR(error_at(line, 160'000), 0.0, line.bound_ns);
  EXPECT_LT(line.bound_ns, 2e6);
}

TEST(ArrivalWindow, Drift_UsesAShortPart) {
  // 50 ppm per second; a line below 16 s of it would be wrong by 1.6 ms at its end.
  const auto late = [](std::int64_t k) {
    const double s = static_cast<double>(k) * 1e-4;
    return 25e-6 * s * s * 1e9;
  };
  const sampling_line line = line_under(160'000, 10e3, late);
  EXPECT_NEAR(error_at(line, 160'000), late(160'000), 300e3);
}

TEST(ArrivalWindow, IgnoresAShortPartThatIsMuchLater) {
  // No drift is so fast: the last 5 s are late because something delayed all arrivals.
  const auto late = [](std::int64_t k) { return k > 110'000 ? 9e6 : 0.0; };
  EXPECT_LT(error_at(line_under(160'000, 10e3, late), 160'000), 1e6);
}

}  // namespace
}  // namespace g4lidar
