// SPDX-License-Identifier: MIT
// Which returns of random scans are marked as isolated and as veiling, against a computation in
// double precision with the functions of libm.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "../support/test_scale.hpp"
#include "g4lidar/filter/outliers.hpp"

namespace g4lidar::test {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

struct place {
  double x;
  double y;
};
place place_of(const point& p) {
  const double angle = static_cast<double>(p.angle_deg) * degree;
  const double range_m = static_cast<double>(p.range_mm) / 1000.0;
  return {range_m * std::cos(angle), range_m * std::sin(angle)};
}

/// The neighbours of point `i` that exist and are returns.
std::vector<place> side_of(const std::vector<point>& points, std::size_t i, std::size_t window,
                           bool joined, int way) {
  std::vector<place> side;
  const auto size = static_cast<std::ptrdiff_t>(points.size());
  for (std::ptrdiff_t k = 1; k <= static_cast<std::ptrdiff_t>(window); ++k) {
    std::ptrdiff_t other = static_cast<std::ptrdiff_t>(i) + way * k;
    if (joined && size > 2 * static_cast<std::ptrdiff_t>(window)) other = (other + size) % size;
    if (other < 0 || other >= size) continue;
    const point& p = points[static_cast<std::size_t>(other)];
    if (!p.is_no_return()) side.push_back(place_of(p));
  }
  return side;
}

/// Nothing where a distance is so near to the limit that single precision may decide otherwise.
std::optional<bool> is_isolated(const std::vector<point>& points, std::size_t i,
                                const speckle_limits& limits, bool joined) {
  if (points[i].is_no_return()) return false;
  const place here = place_of(points[i]);
  const double near_m =
      std::max(static_cast<double>(limits.near_m),
               static_cast<double>(limits.near_ratio) * std::hypot(here.x, here.y));
  std::size_t count = 0;
  for (const int way : {-1, 1}) {
    for (const place& other : side_of(points, i, limits.window, joined, way)) {
      const double distance = std::hypot(other.x - here.x, other.y - here.y);
      if (std::abs(distance - near_m) < 1e-4) return std::nullopt;
      if (distance < near_m) ++count;
    }
  }
  return count < limits.count;
}

std::optional<bool> is_veiling(const std::vector<point>& points, std::size_t i,
                               const edge_limits& limits, bool joined) {
  if (points[i].is_no_return()) return false;
  const place here = place_of(points[i]);
  std::array<bool, 2> nearer{};
  std::array<bool, 2> farther{};
  for (const int way : {-1, 1}) {
    for (const place& other : side_of(points, i, limits.window, joined, way)) {
      const double dx = other.x - here.x;
      const double dy = other.y - here.y;
      const double turn = std::atan2(dy, dx) - std::atan2(here.y, here.x);
      const double off_deg = std::abs(std::remainder(turn / degree, 360.0));
      const double least = static_cast<double>(limits.least_angle_deg);
      if (std::hypot(dx, dy) < 1e-3 || std::abs(off_deg - least) < 0.2) return std::nullopt;
      if (std::abs(180.0 - off_deg - least) < 0.2) return std::nullopt;
      if (off_deg < least) farther[way > 0 ? 1 : 0] = true;
      if (180.0 - off_deg < least) nearer[way > 0 ? 1 : 0] = true;
    }
  }
  return (nearer[0] && farther[1]) || (nearer[1] && farther[0]);
}

TEST(Outliers, RandomScans_AsInDoublePrecision) {
  std::size_t asked = 0;
  std::size_t compared = 0;
  std::size_t found = 0;
  for (const int seed : seeds(300)) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    const auto number = [&](double from, double to) {
      return std::uniform_real_distribution<double>(from, to)(random);
    };
    std::vector<point> points;
    const auto size = static_cast<std::size_t>(number(0.0, 200.0));
    const double level = number(300.0, 12'000.0);
    for (std::size_t i = 0; i < size; ++i) {
      const double kind = number(0.0, 1.0);
      const double range = kind < 0.1   ? 0.0
                           : kind < 0.6 ? level * number(0.95, 1.05)
                                        : number(100.0, 16'000.0);
      point p;
      p.angle_deg = static_cast<float>(i) * 1.8F;
      p.range_mm = static_cast<float>(range);
      p.flags = range == 0.0 ? point_flags::no_return : point_flags::none;
      points.push_back(p);
    }
    const std::size_t window = 1 + static_cast<std::size_t>(number(0.0, 1.0) * number(0.0, 15.99));
    const speckle_limits speckle{window, static_cast<std::size_t>(number(0.0, 4.0)),
                                 static_cast<float>(number(0.0, 0.3)),
                                 static_cast<float>(number(0.0, 0.2))};
    const edge_limits edges{window, static_cast<float>(number(1.0, 45.0))};
    const bool joined = seed % 2 == 0;
    const scan_ends ends = joined ? scan_ends::joined : scan_ends::open;
    std::vector<point> got = points;
    mark_isolated(got, speckle, ends);
    mark_veiling(got, edges, ends);
    asked += 2 * size;
    for (std::size_t i = 0; i < size; ++i) {
      const auto lonely = is_isolated(points, i, speckle, joined);
      const auto between = is_veiling(points, i, edges, joined);
      const bool got_lonely = (got[i].flags & point_flags::isolated) != point_flags::none;
      const bool got_between = (got[i].flags & point_flags::veiling) != point_flags::none;
      EXPECT_EQ(got_lonely, lonely.value_or(got_lonely));
      EXPECT_EQ(got_between, between.value_or(got_between));
      compared += (lonely ? 1U : 0U) + (between ? 1U : 0U);
      found += (lonely.value_or(false) ? 1U : 0U) + (between.value_or(false) ? 1U : 0U);
    }
  }
  EXPECT_GT(10 * compared, 9 * asked);
  EXPECT_GT(20 * found, asked);
}

}  // namespace
}  // namespace g4lidar::test
