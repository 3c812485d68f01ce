// SPDX-License-Identifier: MIT
// What is inside of a polygon: edges, corners, crossings, degenerate outlines.
#include "g4lidar/filter.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "../support/test_scale.hpp"

namespace g4lidar::test {
namespace {

using outline = std::vector<corner>;

TEST(Polygon, ASquare_InEitherSense) {
  constexpr std::array<corner, 4> square{{{1, 1}, {3, 1}, {3, 3}, {1, 3}}};
  static_assert(is_inside({2, 2}, square) && !is_inside({0, 2}, square));
  const outline turned(square.rbegin(), square.rend());
  for (const polygon& each : {polygon(square), polygon(turned)}) {
    EXPECT_TRUE(is_inside({1.001F, 2.999F}, each));
    for (const corner out : {corner{0.999F, 2}, {3.001F, 2}, {2, 0.999F}, {2, 3.001F}, {0, 0}}) {
      EXPECT_FALSE(is_inside(out, each));
    }
    EXPECT_TRUE(is_inside({1, 2}, each)) << "on the left edge";
    EXPECT_TRUE(is_inside({2, 1}, each)) << "on the bottom edge";
    EXPECT_FALSE(is_inside({3, 2}, each)) << "on the right edge";
    EXPECT_FALSE(is_inside({2, 3}, each)) << "on the top edge";
  }
}

TEST(Polygon, NotConvex) {
  const outline hook{{0, 0}, {4, 0}, {4, 4}, {3, 4}, {3, 1}, {0, 1}};
  EXPECT_TRUE(is_inside({3.5F, 3}, hook));
  EXPECT_TRUE(is_inside({1, 0.5F}, hook));
  EXPECT_FALSE(is_inside({1, 3}, hook));
}

TEST(Polygon, WhatASelfCrossingOutlineGoesRoundTwice_IsOutside) {
  outline star;
  for (int i = 0; i < 5; ++i) {
    const double angle = i * 2.0 * 2.0 * std::numbers::pi / 5.0;
    star.push_back({static_cast<float>(std::sin(angle)), static_cast<float>(std::cos(angle))});
  }
  EXPECT_TRUE(is_inside({0, 0.7F}, star)) << "a tip";
  EXPECT_FALSE(is_inside({0, 0}, star)) << "the middle";
  const outline bow_tie{{-1, -1}, {1, 1}, {1, -1}, {-1, 1}};
  EXPECT_TRUE(is_inside({-0.5F, 0}, bow_tie));
  EXPECT_TRUE(is_inside({0.5F, 0}, bow_tie));
  EXPECT_FALSE(is_inside({0, 0.5F}, bow_tie));
}

TEST(Polygon, Degenerate_ContainsNothing) {
  const std::vector<outline> outlines{{},
                                      {{1, 1}},
                                      {{0, 0}, {2, 2}},
                                      {{0, 0}, {1, 1}, {2, 2}},
                                      {{0, 1}, {1, 1}, {2, 1}},
                                      {{1, 1}, {1, 1}, {1, 1}}};
  for (const outline& each : outlines) {
    for (const corner place : {corner{1, 1}, {0, 0}, {0.5F, 0.5F}, {0, 1}, {2, 1}}) {
      EXPECT_FALSE(is_inside(place, each));
    }
  }
}

TEST(Polygon, NotANumber_IsOutside) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const outline square{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  EXPECT_FALSE(is_inside({nan, 0}, square));
  EXPECT_FALSE(is_inside({0, nan}, square));
}

// Triangles from a place in the middle to a ring of corners: they cover the ring, so each place
// inside of it, also one on an edge or in a corner, is in exactly one of them.
TEST(Polygon, OfPolygonsWithCommonEdges_ExactlyOneContainsAPlace) {
  int on_edges = 0;
  for (const int seed : seeds(200)) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    const auto whole = [&](int least, int most) {
      return static_cast<float>(std::uniform_int_distribution<int>(least, most)(random));
    };
    const outline ring{{-8, -8}, {whole(-3, 3), -8}, {8, -8}, {8, whole(-3, 3)},
                       {8, 8},   {whole(-3, 3), 8},  {-8, 8}, {-8, whole(-3, 3)}};
    const corner middle{whole(-4, 4), whole(-4, 4)};
    for (int i = 0; i < 200; ++i) {
      const corner place{whole(-7, 7), whole(-7, 7)};
      int count = 0;
      for (std::size_t k = 0; k < ring.size(); ++k) {
        const outline triangle{middle, ring[k], ring[(k + 1) % ring.size()]};
        count += is_inside(place, triangle) ? 1 : 0;
      }
      ASSERT_EQ(count, 1) << place.x_m << ' ' << place.y_m;
      on_edges += place == middle || place.x_m == middle.x_m ? 1 : 0;
    }
  }
  EXPECT_GT(on_edges, 0);
}

}  // namespace
}  // namespace g4lidar::test
