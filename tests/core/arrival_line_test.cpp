// SPDX-License-Identifier: MIT
// The line below points, compared with a sum over a grid of lines, and its arithmetic with libm.
#include "g4lidar/core/clock/arrival_line.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "support/arrival_model.hpp"
#include "support/test_scale.hpp"

namespace g4lidar {
namespace {

TEST(ArrivalLine, ExponentialAgreesWithLibm) {
  for (double t = 0.0; t < 590.0; t += 0.0137) {
    ASSERT_NEAR(exp_minus(t) / std::exp(-t), 1.0, 1e-9) << t;
  }
  EXPECT_EQ(exp_minus(0.0), 1.0);
  EXPECT_EQ(exp_minus(1e300), 0.0);
  EXPECT_EQ(exp_minus(std::numeric_limits<double>::quiet_NaN()), 0.0);
}

TEST(ArrivalLine, SquareRootAgreesWithLibm) {
  for (double x = 1e-30; x < 1e40; x *= 1.37) {
    ASSERT_NEAR(square_root(x) / std::sqrt(x), 1.0, 1e-9) << x;
  }
  EXPECT_EQ(square_root(0.0), 0.0);
  EXPECT_EQ(square_root(-1.0), 0.0);
}

struct xy {
  double x, y;
};

/// The same estimate by its definition: each line of a grid has the weight e^(sum of its height /
/// delay), or 0 if it is above a point.
line_estimate by_grid(const std::vector<xy>& points, double lowest, double highest, double delay) {
  const auto n = static_cast<double>(points.size());
  double mean_x = 0.0;
  for (const xy& p : points) mean_x += p.x / n;
  constexpr int steps = 2000;
  std::vector<double> slopes;
  std::vector<double> tops;
  double best = -1e300;
  for (int i = 0; i < steps; ++i) {
    const double slope = lowest + (highest - lowest) * (i + 0.5) / steps;
    double top = 1e300;
    for (const xy& p : points) top = std::min(top, p.y - slope * p.x);
    slopes.push_back(slope);
    tops.push_back(top);
    best = std::max(best, top + slope * mean_x);
  }
  double weight = 0.0, o1 = 0.0, o2 = 0.0, s1 = 0.0, s2 = 0.0;
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    for (int j = 0; j < 400; ++j) {  // offsets below the highest, in twentieths of the mean
      const double below = (j + 0.5) * 0.05 * delay / n;
      const double offset = tops[i] - below;
      const double w = std::exp(n / delay * (offset + slopes[i] * mean_x - best));
      weight += w;
      o1 += w * offset;
      o2 += w * offset * offset;
      s1 += w * slopes[i];
      s2 += w * slopes[i] * slopes[i];
    }
  }
  line_estimate result;
  result.offset = o1 / weight;
  result.offset_deviation = std::sqrt(o2 / weight - result.offset * result.offset);
  result.slope = s1 / weight;
  result.slope_deviation = std::sqrt(s2 / weight - result.slope * result.slope);
  return result;
}

TEST(ArrivalLine, AgreesWithASumOverAllLines) {
  for (const int seed : test::seeds(8)) {
    SCOPED_TRACE(seed);
    arrivals::model dice(arrivals::options{.seed = static_cast<std::uint64_t>(seed)});
    const auto count = static_cast<std::size_t>(1 + dice.bits() % 40);
    std::vector<xy> points;
    line_under_points line;
    double x = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      points.push_back({x, 3.0 - 0.7 * x + dice.exponential(1.0)});
      line.add_left(x, points.back().y);
      x -= 0.2 + dice.uniform();
    }
    const line_estimate found = line.estimate(-2.0, 1.0, 0.5);
    const line_estimate wanted = by_grid(points, -2.0, 1.0, found.mean_delay);
    EXPECT_NEAR(found.offset, wanted.offset, 0.01 * wanted.offset_deviation);
    EXPECT_NEAR(found.offset_deviation / wanted.offset_deviation, 1.0, 0.01);
    EXPECT_NEAR(found.slope, wanted.slope, 0.01 * wanted.slope_deviation);
    EXPECT_NEAR(found.slope_deviation / wanted.slope_deviation, 1.0, 0.01);
  }
}

TEST(ArrivalLine, MeasuresTheMeanDelay) {
  arrivals::model dice(arrivals::options{.seed = 5});
  double sum = 0.0;
  for (int repeat = 0; repeat < 200; ++repeat) {
    line_under_points line;
    for (int i = 0; i < 64; ++i) line.add_left(-i, 10.0 + dice.exponential(2.0));
    sum += line.estimate(-1.0, 1.0, 2.0).mean_delay;
  }
  EXPECT_NEAR(sum / 200.0, 2.0, 0.1);
}

TEST(ArrivalLine, RespectsTheLimitsOfTheSlope) {
  line_under_points line;
  for (int i = 0; i < 64; ++i) line.add_left(-i, 5.0 + 3.0 * i);  // a slope of -3
  const line_estimate found = line.estimate(-0.1, 0.1, 1.0);
  EXPECT_LT(found.slope, -0.04);
  EXPECT_GE(found.slope, -0.1);
}

}  // namespace
}  // namespace g4lidar
