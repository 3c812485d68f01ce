// SPDX-License-Identifier: MIT
// The estimator of the twist with lost, partial, hostile and many points, and its memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "g4lidar/motion/twist_estimator.hpp"
#include "motion/driven_lidar.hpp"
#include "motion/twist_errors.hpp"
#include "support/allocation_count.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;

TEST(twist_estimator_input, reports_a_lost_revolution_and_goes_on) {
  const drive how = {.twist = {0.3, 0.0, -0.4}};
  driven_lidar lidar(office(), how, 1);
  twist_estimator estimator;
  EXPECT_EQ(estimator.add(lidar.revolution()).status, twist_status::first_scan);
  EXPECT_EQ(estimator.add(lidar.revolution()).status, twist_status::known);
  (void)lidar.revolution();
  const twist_estimate lost = estimator.add(lidar.revolution());
  EXPECT_EQ(lost.status, twist_status::lost_revolution);
  EXPECT_GE(lost.covariance[4], 100.0);
  EXPECT_EQ(estimator.add(lidar.revolution()).status, twist_status::known);
}

TEST(twist_estimator_input, accepts_a_piece_as_the_first_scan) {
  for (const double first_angle_deg : {20.0, 90.0, 180.0, 270.0, 300.0, 355.0}) {
    const drive how = {.twist = {0.3, 0.1, 0.8}, .first_angle_deg = first_angle_deg};
    driven_lidar lidar(office(), how, 5);
    twist_estimator estimator;
    (void)estimator.add(lidar.revolution());
    const twist_estimate piece = estimator.add(lidar.revolution());
    EXPECT_EQ(piece.is_known(), first_angle_deg < 350.0) << first_angle_deg;
    if (piece.is_known()) {
      EXPECT_LT(normalised_square(piece, how.twist), 20.0);
    }
    const twist_estimate whole = estimator.add(lidar.revolution());
    EXPECT_TRUE(whole.is_known());
    EXPECT_LT(error_of(whole.twist, how.twist).speed, 0.05);
  }
}

bool is_finite(const twist_estimate& made) {
  return std::isfinite(made.twist.x_m_per_s) && std::isfinite(made.twist.y_m_per_s) &&
         std::isfinite(made.twist.yaw_rad_per_s) &&
         std::ranges::all_of(made.covariance, [](double c) { return std::isfinite(c); });
}

TEST(twist_estimator_input, stays_finite_whatever_it_receives) {
  driven_lidar lidar(office(), {.twist = {0.3, 0.0, 0.4}}, 1);
  const std::vector<std::function<void(std::vector<point>&)>> changes = {
      [](auto& all) {
        for (point& p : all) p.range_mm = 1000.0F;
      },
      [](auto& all) {
        for (point& p : all) p.range_mm = 0.0F;
      },
      [](auto& all) {
        for (point& p : all) p.range_mm = 100.0F;
      },
      [](auto& all) {
        for (point& p : all) p.angle_deg = 7.0F;
      },
      [](auto& all) {
        for (point& p : all) p.angle_deg = 7.0F, p.range_mm = 3000.0F;
      },
      [](auto& all) {
        for (point& p : all) p.range_mm = std::numeric_limits<float>::quiet_NaN();
      },
      [](auto& all) {
        for (point& p : all) p.range_mm = std::numeric_limits<float>::infinity();
      },
      [](auto& all) {
        for (point& p : all) p.angle_deg = std::numeric_limits<float>::quiet_NaN();
      },
      [](auto& all) {
        for (point& p : all) p.angle_deg = 1e30F;
      },
      [](auto& all) {
        for (point& p : all) p.time_ns = 0;
      },
      [](auto& all) {
        for (point& p : all) p.time_ns = all.front().time_ns;
      },
      [](auto& all) {
        for (point& p : all) p.time_ns = -p.time_ns;
      },
      [](auto& all) { std::ranges::reverse(all); },
      [](auto& all) { all[100].time_ns = std::numeric_limits<std::int64_t>::max(); },
      [](auto& all) { all.back().time_ns = std::numeric_limits<std::int64_t>::max(); },
      [](auto& all) { all.front().time_ns = std::numeric_limits<std::int64_t>::min(); },
      [](auto& all) { all.clear(); },
      [](auto& all) { all.resize(1); },
      [](auto& all) {
        std::vector<point> twice;
        for (const point& p : all) twice.insert(twice.end(), 2, p);
        all = twice;
      },
      [](auto& all) {
        std::mt19937 random(1);
        for (point& p : all) p.range_mm = static_cast<float>(random() % 16000);
      },
  };
  for (std::size_t i = 0; i < changes.size(); ++i) {
    twist_estimator estimator;
    for (int round = 0; round < 3; ++round) {
      std::vector<point> points = lidar.revolution();
      EXPECT_TRUE(is_finite(estimator.add(points))) << i;
      points = lidar.revolution();
      changes[i](points);
      EXPECT_TRUE(is_finite(estimator.add(points))) << i;
      points = lidar.revolution();
      changes[i](points);
      const twist_estimate made = estimator.add(points);
      EXPECT_TRUE(is_finite(made)) << i;
    }
    (void)estimator.add(lidar.revolution());
    EXPECT_TRUE(estimator.add(lidar.revolution()).is_known()) << i;
  }
}

TEST(twist_estimator_input, leaves_unusable_points_out) {
  const drive how = {.twist = {0.3, 0.0, 0.4}};
  driven_lidar lidar(office(), how, 1);
  twist_estimator estimator;
  twist_estimate made;
  for (int i = 0; i < 2; ++i) {
    std::vector<point> points = lidar.revolution();
    for (std::size_t k = 0; k < points.size(); k += 3)
      points[k].range_mm = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t k = 1; k < points.size(); k += 9) points[k].angle_deg = -1e30F;
    made = estimator.add(points);
  }
  EXPECT_TRUE(made.is_known());
  EXPECT_LT(error_of(made.twist, how.twist).speed, 0.05);
}

TEST(twist_estimator_input, reports_missing_times) {
  driven_lidar lidar(office(), {}, 1);
  twist_estimator estimator;
  (void)estimator.add(lidar.revolution());
  std::vector<point> points = lidar.revolution();
  for (point& p : points) p.time_ns = 0;
  EXPECT_EQ(estimator.add(points).status, twist_status::no_times);
  EXPECT_EQ(estimator.add(lidar.revolution()).status, twist_status::no_times);
  EXPECT_EQ(estimator.add(lidar.revolution()).status, twist_status::known);
}

TEST(twist_estimator_input, reports_scans_of_different_places) {
  driven_lidar first(office(), {}, 1);
  driven_lidar second(pillars(), {.twist = {}, .start = {3.0, 2.0, 1.0}}, 2);
  twist_estimator estimator;
  (void)estimator.add(first.revolution());
  (void)second.revolution();
  const twist_estimate made = estimator.add(second.revolution());
  EXPECT_THAT(made.status,
              testing::AnyOf(twist_status::no_correspondence, twist_status::too_few_returns));
}

TEST(twist_estimator_input, uses_a_part_of_very_many_points) {
  // Three lidars' worth: each point three times.
  const drive how = {.twist = {0.3, 0.0, 0.4}, .frequency_hz = 5.0};
  driven_lidar lidar(office(), how, 1);
  twist_estimator estimator;
  twist_estimate made;
  for (int i = 0; i < 2; ++i) {
    std::vector<point> points;
    for (const point& p : lidar.revolution()) points.insert(points.end(), 3, p);
    made = estimator.add(points);
  }
  EXPECT_TRUE(made.is_known());
  EXPECT_LT(error_of(made.twist, how.twist).speed, 0.05);
}

TEST(twist_estimator_input, never_allocates_after_construction) {
  driven_lidar lidar(office(), {.twist = {0.3, 0.0, 0.4}}, 1);
  twist_estimator estimator;
  for (int i = 0; i < 3; ++i) {
    const std::vector<point> points = lidar.revolution();
    EXPECT_EQ(allocations_in([&] { (void)estimator.add(points); }), 0U);
  }
  EXPECT_EQ(allocations_in([&] { estimator.reset(); }), 0U);
  EXPECT_EQ(estimator.add(lidar.revolution()).status, twist_status::first_scan);
}

TEST(twist_estimator_input, moves) {
  driven_lidar lidar(office(), {}, 1);
  twist_estimator one;
  (void)one.add(lidar.revolution());
  twist_estimator two = std::move(one);
  EXPECT_TRUE(two.add(lidar.revolution()).is_known());
}

}  // namespace
