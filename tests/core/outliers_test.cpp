// SPDX-License-Identifier: MIT
// Which returns are marked as isolated and as veiling: constructed scans of poles, walls and mixed
// pixels.
#include "g4lidar/filter/outliers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "../support/test_scale.hpp"

namespace g4lidar::test {
namespace {

// 9000 samples per second at 7 revolutions per second.
constexpr double step_deg = 360.0 * 7.0 / 9000.0;
constexpr double degree = std::numbers::pi / 180.0;

point at(double angle_deg, double range_mm) {
  point p;
  p.angle_deg = wrap_deg(static_cast<float>(angle_deg));
  p.range_mm = static_cast<float>(std::round(range_mm * 4.0) / 4.0);
  p.flags = range_mm == 0.0 ? point_flags::no_return : point_flags::none;
  return p;
}

/// Samples of a whole turn from `start_deg` on: `range_mm` is the range in a direction in degrees.
std::vector<point> scan_of(const std::function<double(double)>& range_mm, double start_deg = 0.0) {
  std::vector<point> points;
  for (int i = 0; i < 1286; ++i) {
    const double direction = start_deg + i * step_deg;
    points.push_back(at(direction, range_mm(direction)));
  }
  return points;
}

std::vector<std::size_t> marked(const std::vector<point>& points, point_flags flag) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if ((points[i].flags & flag) != point_flags::none) found.push_back(i);
  }
  return found;
}

std::vector<std::size_t> isolated(std::vector<point> points, const speckle_limits& limits = {},
                                  scan_ends ends = scan_ends::joined) {
  const std::size_t count = mark_isolated(points, limits, ends);
  const auto found = marked(points, point_flags::isolated);
  EXPECT_EQ(found.size(), count);
  return found;
}

std::vector<std::size_t> veiling(std::vector<point> points, const edge_limits& limits = {},
                                 scan_ends ends = scan_ends::joined) {
  const std::size_t count = mark_veiling(points, limits, ends);
  const auto found = marked(points, point_flags::veiling);
  EXPECT_EQ(found.size(), count);
  return found;
}

using indices = std::vector<std::size_t>;

/// Neighbours at these ranges, from 100 degrees on.
std::vector<point> row_of(const std::vector<double>& ranges_mm, double apart_deg = step_deg) {
  std::vector<point> points;
  for (const double range_mm : ranges_mm) {
    points.push_back(at(100.0 + apart_deg * static_cast<double>(points.size()), range_mm));
  }
  return points;
}

// ---- isolated returns ------------------------------------------------------------------------

// A wall at 10 degrees to the beam. An X2 measures every 0.84 degrees at 7 Hz, a T-mini every 0.9 at 10 Hz, a G4 every
// 0.28 at 7 Hz: the points of an X2 on it are three times as far apart.
TEST(Isolated, AWallAtAnAngle_IsKeptHoweverFarTheSamplesAreApart) {
  const auto count_of = [](int samples, float near_ratio = -1.0F) {
    std::vector<point> points;
    for (int i = 0; i < samples / 12; ++i) {  // 30 degrees of it
      const double turned = i * 360.0 / samples;
      const double range_mm = 2000.0 * std::sin(10.0 * degree) / std::sin((10.0 + turned) * degree);
      points.push_back(at(turned, range_mm));
    }
    return mark_isolated(points, {.near_ratio = near_ratio}, scan_ends::open);
  };
  for (const int samples : {1286, 750, 571, 428, 400, 333})
    EXPECT_EQ(count_of(samples), 0U) << samples;
  EXPECT_GT(count_of(428, 0.05F), 0U) << "samples of an X2 with the ratio of a G4";
  EXPECT_FLOAT_EQ(speckle_limits{}.near_ratio_at(0.84F), 0.15F);
  EXPECT_FLOAT_EQ(speckle_limits{}.near_ratio_at(0.18F), 0.05F) << "a TG30 at 10 Hz";
  EXPECT_FLOAT_EQ(speckle_limits{.near_ratio = 0.01F}.near_ratio_at(0.9F), 0.01F);
}

// The angle between samples is that between neighbours, in whichever direction a revolution begins; a gap, in which
// packets were lost, is none.
TEST(Isolated, TheAngleBetweenSamples_DoesNotChangeByAGap) {
  std::vector<point> points;
  for (int i = 0; i < 400; ++i) {
    if (i < 100 || i >= 180) points.push_back(at(200.0 + i * 0.9, 5000.0));
  }
  EXPECT_NEAR(detail::mean_step_deg(points), 0.9F, 1e-3);
  EXPECT_EQ(detail::mean_step_deg(std::span(points).first(1)), 0.0F);
}

TEST(Isolated, TheAngleBetweenSamplesOfAStream_IsThatOfItsLastWholeRevolution) {
  std::vector<point> points;
  for (const auto& [revolution, samples] :
       {std::pair{3U, 100}, {4U, 400}, {5U, 500}, {7U, 90}, {8U, 1}}) {
    for (int i = 0; i < samples; ++i) {
      if (revolution == 5 && i >= 100 && i < 350) continue;  // they are lost
      points.push_back(at(i * 360.0 / samples, 4000.0));
      points.back().revolution = revolution;
    }
  }
  for (const std::size_t piece : {1U, 7U, 450U, 2000U}) {
    sample_spacing spacing(*model_named("x2"));
    std::vector<float> passed{spacing.step_deg()};
    for (std::size_t i = 0; i < points.size(); i += piece) {
      const std::span<const point> rest = std::span(points).subspan(i);
      spacing.add(rest.first(std::min(piece, rest.size())));
      if (passed.back() != spacing.step_deg()) passed.push_back(spacing.step_deg());
    }
    EXPECT_FLOAT_EQ(passed.front(), 0.84F);
    EXPECT_NEAR(passed.back(), 0.72F, 1e-4)
        << "revolution 6 is missing, and 7 is not known to be whole";
    if (piece < 100) {
      EXPECT_NEAR(passed.at(1), 0.9F, 1e-4);
    }
  }
}

TEST(Isolated, OneReturnAlone_IsMarked_TwoInARowAreNot) {
  const std::vector<point> one = row_of({4000, 4000, 4000, 2000, 4000, 4000, 4000});
  EXPECT_EQ(isolated(one), indices{3});
  EXPECT_EQ(isolated(row_of({4000, 4000, 4000, 2000, 2000, 4000, 4000, 4000})), indices{});
  // With a sample between them they are neighbours in a window of 2, not of 1.
  const std::vector<point> apart = row_of({4000, 4000, 4000, 2000, 4000, 2000, 4000, 4000, 4000});
  EXPECT_EQ(isolated(apart), indices{});
  EXPECT_EQ(isolated(apart, {.window = 1}), (indices{3, 4, 5}));
}

TEST(Isolated, SamplesWithoutReturn_AreNeitherNeighboursNorMarked) {
  EXPECT_EQ(isolated(row_of({0, 0, 0, 2000, 0, 0, 0})), indices{3});
  EXPECT_EQ(isolated(row_of({0, 0, 0, 0, 0, 0, 0})), indices{});
  EXPECT_EQ(isolated(row_of({0, 0, 0, 2000, 0, 2000, 0})), indices{});
}

TEST(Isolated, Count_IsTheNumberOfNearNeighbours) {
  const std::vector<point> three = row_of({0, 0, 0, 2000, 2000, 2000, 0, 0, 0});
  EXPECT_EQ(isolated(three, {.count = 2}), indices{});
  EXPECT_EQ(isolated(three, {.count = 3}), (indices{3, 4, 5}));
  EXPECT_EQ(isolated(three, {.window = 1, .count = 2}), (indices{3, 5}));
  EXPECT_EQ(isolated(row_of({0, 2000, 0}), {.count = 0}), indices{});
}

// On one beam distances are differences of ranges: both limits are included.
TEST(Isolated, Near_IsADistanceOrAShareOfTheRange_WhicheverIsMore) {
  const auto pair = [](double first_mm, double second_mm) {
    return isolated(row_of({0, 0, first_mm, second_mm, 0, 0}, 0.0),
                    {.near_m = 0.0625F, .near_ratio = 0.0625F});
  };
  EXPECT_EQ(pair(500, 562), indices{});
  EXPECT_EQ(pair(500, 563), (indices{2, 3}));
  EXPECT_EQ(pair(8000, 8499), indices{});
  EXPECT_EQ(pair(8000, 8510), indices{2}) << "for the farther one 6.25 % are 532 mm";
  EXPECT_EQ(pair(8000, 8600), (indices{2, 3}));
}

TEST(Isolated, EndsOfARevolution_AreJoined_ThoseOfAPieceAreNot) {
  std::vector<point> points = scan_of([](double) { return 0.0; });
  points.front() = at(0.0, 2000.0);
  points.back() = at(-step_deg, 2000.0);
  EXPECT_EQ(isolated(points), indices{});
  EXPECT_EQ(isolated(points, {}, scan_ends::open), (indices{0, 1285}));
}

// ---- veiling points --------------------------------------------------------------------------

TEST(Veiling, ARangeBetweenTwoWalls_IsMarked_FromTheStatedDistanceOn) {
  // 2 m and 4 m. Neighbours are 0.28 degrees apart; 5 degrees are 5.59 % of the range
  // of each wall.
  for (double between = 2010.0; between < 4000.0; between += 10.0) {
    const bool is_found = between - 2000.0 > 0.0565 * 2000.0 && 4000.0 - between > 0.0565 * 4000.0;
    const bool is_kept = between - 2000.0 < 0.0553 * 2000.0 || 4000.0 - between < 0.0553 * 4000.0;
    const std::vector<point> rising = row_of({2000, 2000, 2000, between, 4000, 4000, 4000});
    const std::vector<point> falling = row_of({4000, 4000, 4000, between, 2000, 2000, 2000});
    SCOPED_TRACE(between);
    for (const auto& points : {rising, falling}) {
      const indices found = veiling(points);
      EXPECT_TRUE(!is_found || found == indices{3});
      EXPECT_TRUE(!is_kept || found.empty());
    }
  }
}

TEST(Veiling, SeveralInARow_AreMarked) {
  EXPECT_EQ(veiling(row_of({2000, 2000, 2500, 3000, 3500, 4000, 4000})), (indices{2, 3, 4}));
}

TEST(Veiling, EdgesAndThingsInFrontOfEverything_AreKept) {
  EXPECT_EQ(veiling(row_of({2000, 2000, 2000, 4000, 4000, 4000})), indices{});
  EXPECT_EQ(veiling(row_of({4000, 4000, 2000, 4000, 4000})), indices{}) << "one sample in front";
  EXPECT_EQ(veiling(row_of({2000, 2000, 4000, 2000, 2000})), indices{}) << "a slit";
  EXPECT_EQ(veiling(row_of({0, 0, 2000, 3000, 0, 0})), indices{}) << "beside nothing";
}

TEST(Veiling, AThingOfTwoSamplesAtMidDepth_IsKeptByAWindowOfOne) {
  const std::vector<point> leg = row_of({2000, 2000, 2000, 3000, 3000, 4000, 4000, 4000});
  EXPECT_EQ(veiling(leg), indices{});
  EXPECT_EQ(veiling(leg, {.window = 2}), (indices{3, 4}));
}

TEST(Veiling, AWindow_LooksOverSamplesWithoutReturn) {
  const std::vector<point> gap = row_of({2000, 2000, 0, 3000, 0, 4000, 4000});
  EXPECT_EQ(veiling(gap), indices{});
  EXPECT_EQ(veiling(gap, {.window = 2}), indices{3});
}

TEST(Veiling, EndsOfARevolution_AreJoined_ThoseOfAPieceAreNot) {
  std::vector<point> points =
      scan_of([](double degrees) { return degrees < 180.0 ? 4000.0 : 2000.0; });
  points.front() = at(0.0, 3000.0);
  EXPECT_EQ(veiling(points), indices{0});
  EXPECT_EQ(veiling(points, {}, scan_ends::open), indices{});
}

// ---- what is kept of real things -------------------------------------------------------------

// A pole of 3 cm at 2 m before a wall at 4 m, at 100 places between the beams: every return of both.
TEST(Outliers, AThinPole_KeepsAllReturns) {
  const double radius = 15.0;
  for (int phase = 0; phase < 100; ++phase) {
    int hits = 0;
    const std::vector<point> points = scan_of(
        [&](double degrees) {
          const double off = std::abs(std::remainder(degrees - 90.0, 360.0)) * degree;
          const double beside = 2000.0 * std::sin(off);
          if (off > 1.0 || beside > radius) return 4000.0;
          ++hits;
          return 2000.0 * std::cos(off) - std::sqrt(radius * radius - beside * beside);
        },
        phase * 0.01 * step_deg);
    EXPECT_GE(hits, 3);
    EXPECT_EQ(isolated(points), indices{}) << phase;
    EXPECT_EQ(veiling(points), indices{}) << phase;
  }
}

// A wall that passes the lidar at 1 m, out to where the beams meet it at 10 degrees.
std::vector<point> grazed_wall(const std::function<double(double)>& with_noise) {
  std::vector<point> points;
  for (double degrees = 10.1; degrees < 169.9; degrees += step_deg) {
    points.push_back(at(degrees, with_noise(1000.0 / std::sin(degrees * degree))));
  }
  return points;
}

TEST(Outliers, AWallDownTo10Degrees_KeepsAllReturns) {
  const std::vector<point> points = grazed_wall([](double mm) { return mm; });
  EXPECT_EQ(isolated(points, {}, scan_ends::open), indices{});
  EXPECT_EQ(veiling(points, {}, scan_ends::open), indices{});
}

TEST(Outliers, AWallWithNoise_KeepsNearlyAllReturns) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::size_t points = 0;
  std::size_t lonely = 0;
  std::size_t between = 0;
  for (int i = 0; i < scaled(200); ++i) {
    const auto wall =
        grazed_wall([&](double mm) { return mm + normal(random) * (4.0 + 0.003 * mm); });
    points += wall.size();
    lonely += isolated(wall, {}, scan_ends::open).size();
    between += veiling(wall, {}, scan_ends::open).size();
  }
  EXPECT_LT(static_cast<double>(lonely), 1e-3 * static_cast<double>(points));
  EXPECT_LT(static_cast<double>(between), 1e-3 * static_cast<double>(points));
}

// ---- the interface ---------------------------------------------------------------------------

TEST(Outliers, OtherFlagsStay_OldMarksAreCleared) {
  using enum point_flags;
  std::vector<point> points = row_of({4000, 4000, 4000, 2000, 4000, 4000, 4000});
  points[0].flags = revolution_start | isolated | veiling;
  points[3].flags = veiling;
  mark_isolated(points);
  EXPECT_EQ(points[0].flags, revolution_start | veiling);
  EXPECT_EQ(points[3].flags, isolated | veiling);
  mark_veiling(points);
  EXPECT_EQ(points[0].flags, revolution_start);
  EXPECT_EQ(points[3].flags, isolated);
}

TEST(Outliers, OtherMemory_GetsAllPoints) {
  const std::vector<point> points = row_of({4000, 4000, 3000, 2000, 0, 0, 4000});
  std::vector<point> same = points;
  std::vector<point> other(10);
  EXPECT_EQ(mark_isolated(points, other, {}), mark_isolated(same));
  same.resize(10);
  EXPECT_EQ(other, same);
  same.resize(7);
  EXPECT_EQ(mark_veiling(points, other, {}), mark_veiling(same));
  EXPECT_EQ(marked(other, point_flags::veiling), indices{2});
}

TEST(Outliers, FewPoints) {
  for (std::size_t size = 0; size < 40; ++size) {
    const std::vector<point> points = row_of(std::vector<double>(size, 1000.0));
    for (const std::size_t window : {std::size_t{1}, std::size_t{2}, max_window}) {
      EXPECT_EQ(isolated(points, {.window = window}).size(), size == 1 ? 1U : 0U);
      EXPECT_EQ(veiling(points, {.window = window}), indices{});
    }
  }
}

TEST(Outliers, AtCompileTime) {
  constexpr auto count = [] {
    std::array<point, 5> points;
    for (point& p : points) p.range_mm = 4000.0F;
    points[2].range_mm = 1000.0F;
    return mark_isolated(points) + mark_veiling(points);
  };
  static_assert(count() == 1);
}

}  // namespace
}  // namespace g4lidar::test
