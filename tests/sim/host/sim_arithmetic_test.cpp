// SPDX-License-Identifier: MIT
// The simulator's own trigonometry and random numbers, compared with libm and known sequences.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "g4lidar/sim/arithmetic.hpp"
#include "g4lidar/sim/random.hpp"
#include "g4lidar/sim/ray_caster.hpp"

namespace {

using namespace g4lidar;

constexpr long double radian = std::numbers::pi_v<long double> / 180.0L;

TEST(SimArithmetic, SineAndCosineAreWithin3em16OfLibm) {
  sim::random_stream random(1);
  long double worst = 0.0L;
  for (int i = 0; i < 200'000; ++i) {
    const double degrees = (random.uniform() - 0.5) * (i % 2 == 0 ? 720.0 : 90.0);
    const sim::sin_cos both = sim::sin_cos_deg(degrees);
    const long double sine = static_cast<long double>(both.sine);
    const long double cosine = static_cast<long double>(both.cosine);
    const long double x = static_cast<long double>(degrees) * radian;
    worst = std::max(worst, std::fabs(sine - std::sin(x)));
    worst = std::max(worst, std::fabs(cosine - std::cos(x)));
  }
  EXPECT_LT(worst, 3e-16L);
}

TEST(SimArithmetic, SineAndCosineAreExactAtQuarters) {
  for (int turn = -4; turn <= 4; ++turn) {
    const double sign = turn % 2 == 0 ? 1.0 : -1.0;
    EXPECT_EQ(sim::sin_cos_deg(turn * 180.0).sine, 0.0);
    EXPECT_EQ(sim::sin_cos_deg(turn * 180.0).cosine, sign);
    EXPECT_EQ(sim::sin_cos_deg(turn * 180.0 + 90.0).sine, sign);
    EXPECT_EQ(sim::sin_cos_deg(turn * 180.0 + 90.0).cosine, 0.0);
  }
}

TEST(SimArithmetic, ArctangentIsWithin3em14DegreesOfLibm) {
  sim::random_stream random(2);
  long double worst = 0.0L;
  for (int i = 0; i < 200'000; ++i) {
    const double size = std::exp2((random.uniform() - 0.5) * 60.0);
    const double x = i % 2 == 0 ? size : -size;
    const long double truth = std::atan(static_cast<long double>(x)) / radian;
    const long double own = static_cast<long double>(sim::atan_deg(x));
    worst = std::max(worst, std::fabs(own - truth));
  }
  EXPECT_LT(worst, 3e-14L);
  EXPECT_EQ(sim::atan_deg(0.0), 0.0);
  EXPECT_EQ(sim::atan_deg(std::numeric_limits<double>::infinity()), 90.0);
  EXPECT_EQ(sim::atan_deg(-std::numeric_limits<double>::infinity()), -90.0);
}

TEST(SimArithmetic, ArctangentOfTwoNumbersFindsTheQuarter) {
  for (int degrees = 0; degrees < 360; ++degrees) {
    const auto [sine, cosine] = sim::sin_cos_deg(degrees);
    EXPECT_NEAR(sim::atan2_deg(sine * 3.0, cosine * 3.0), degrees, 1e-13);
  }
  EXPECT_EQ(sim::atan2_deg(0.0, 0.0), 0.0);
  EXPECT_LT(sim::atan2_deg(-1e-300, 1.0), 360.0);
}

TEST(SimArithmetic, CorrectionIsThatOfTheManual) {
  const std::array<std::array<double, 3>, 6> examples{{{0.25, 89.34, 0.005},
                                                       {10.0, 63.88, 0.005},
                                                       {155.3, 0.0, 1e-12},
                                                       {280.0, -3.577, 0.0005},
                                                       {1000.0, -6.762186, 5e-7},
                                                       {8000.0, -7.837425, 5e-7}}};
  for (const auto& [range_mm, degrees, tolerance] : examples) {
    EXPECT_NEAR(sim::correction_deg(range_mm), degrees, tolerance) << range_mm;
  }
  for (double d = 0.25; d < 16384.0; d += 0.25) {
    const double manual = std::atan(21.8 * (155.3 - d) / (155.3 * d)) * 180.0 / std::numbers::pi;
    ASSERT_NEAR(sim::correction_deg(d), manual, 1e-12) << d;
  }
  EXPECT_NEAR(sim::correction_deg(1e18), sim::far_correction_deg, 1e-13);
}

TEST(SimRandom, GivesTheNumbersOfAnIndependentImplementation) {
  sim::random_stream plain(0);
  for (const std::uint64_t expected :
       {0xFB5405F7BD79C540U, 0x780C98E26CEA5883U, 0x2A146E0980FEBC66U}) {
    EXPECT_EQ(plain.next(), expected);
  }
  for (int i = 4; i < 100; ++i) (void)plain.next();
  EXPECT_EQ(plain.next(), 0xEDF949D188C92807U);
  sim::random_stream with_purpose(1, 2);
  for (const std::uint64_t expected :
       {0x84F02F195AB5FD66U, 0x46FF6F0DAAF44911U, 0x8276408E60C29367U}) {
    EXPECT_EQ(with_purpose.next(), expected);
  }
}

TEST(SimRandom, UniformNumbersLieEvenlyInTheUnitInterval) {
  sim::random_stream random(3);
  std::array<int, 10> count{};
  for (int i = 0; i < 100'000; ++i) {
    const double x = random.uniform();
    ASSERT_GE(x, 0.0);
    ASSERT_LT(x, 1.0);
    ++count[static_cast<std::size_t>(x * 10.0)];
  }
  for (const int n : count) EXPECT_NEAR(n, 10'000, 500);
}

TEST(SimRandom, GaussianNumbersHaveTheMomentsOfOne) {
  sim::random_stream random(4);
  constexpr int n = 400'000;
  double sum = 0.0;
  double squares = 0.0;
  int beyond_two = 0;
  for (int i = 0; i < n; ++i) {
    const double x = random.gaussian();
    ASSERT_LE(std::fabs(x), 6.0);
    sum += x;
    squares += x * x;
    beyond_two += std::fabs(x) > 2.0 ? 1 : 0;
  }
  EXPECT_NEAR(sum / n, 0.0, 0.01);
  EXPECT_NEAR(squares / n, 1.0, 0.01);
  EXPECT_NEAR(beyond_two / static_cast<double>(n), 0.0455, 0.003);
}

}  // namespace
