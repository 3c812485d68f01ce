// SPDX-License-Identifier: MIT
// The twist of a lidar from its scans: its errors, its covariance, and what is not known.
#include "g4lidar/motion/twist_estimator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "motion/driven_lidar.hpp"
#include "motion/twist_errors.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;

/// Drives from standing to fast, in all directions; 63 in all.
std::vector<drive> many_drives(double rate_hz = 9000.0,
                               const std::vector<double>& frequencies_hz = {5.0, 7.0, 12.0}) {
  std::vector<drive> made;
  for (const double frequency_hz : frequencies_hz)
    for (const double yaw_deg : {0.0, 30.0, -30.0, 90.0, -90.0, 180.0, -180.0})
      for (const double speed : {0.0, 0.5, 1.0}) {
        const double course = 0.1 * yaw_deg + speed;  // any
        made.push_back(
            {.twist = {speed * std::cos(course), speed * std::sin(course), yaw_deg * degree},
             .frequency_hz = frequency_hz,
             .rate_hz = rate_hz});
      }
  return made;
}

/// The errors of all `drives` from a cold start, and how many twists were not known.
struct cold_starts {
  std::vector<double> speed;  ///< m/s
  std::vector<double> yaw;    ///< degrees/s
  int unknown = 0;
};
cold_starts start_cold(const surroundings& around, const std::vector<drive>& drives) {
  cold_starts all;
  for (drive how : drives) {
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
      how.turn_deg = seed <= 2 ? 180.0 : 0.0;
      const twist_estimate made = estimate(around, how, seed);
      if (!made.is_known()) {
        ++all.unknown;
        continue;
      }
      const auto error = error_of(made.twist, how.twist);
      all.speed.push_back(error.speed);
      all.yaw.push_back(error.yaw / degree);
    }
  }
  return all;
}

class twist_in_rooms : public testing::TestWithParam<std::pair<const char*, surroundings (*)()>> {};

TEST_P(twist_in_rooms, is_near_the_truth_from_a_cold_start) {
  const cold_starts all = start_cold(GetParam().second(), many_drives());
  EXPECT_EQ(all.unknown, 0);
  EXPECT_LT(percentile(all.speed, 95), 0.025);
  EXPECT_LT(percentile(all.yaw, 95), 0.4);
}

// 4,000 points in a revolution, a TG30 with 20 kHz at 5 Hz: the promise of a G4.
TEST_P(twist_in_rooms, is_near_the_truth_with_a_lidar_of_many_points) {
  const cold_starts all = start_cold(GetParam().second(), many_drives(20'000.0, {5.0}));
  EXPECT_EQ(all.unknown, 0);
  EXPECT_LT(percentile(all.speed, 95), 0.025);
  EXPECT_LT(percentile(all.yaw, 95), 0.4);
}

// 430 points in a revolution, an X2 with 3 kHz at 7 Hz: twice the errors of a G4.
TEST_P(twist_in_rooms, is_near_the_truth_with_a_lidar_of_few_points) {
  const cold_starts all = start_cold(GetParam().second(), many_drives(3000.0, {7.0}));
  EXPECT_LT(all.unknown, 21);  // of 84: in the hall, where pillars have few points
  EXPECT_LT(percentile(all.speed, 95), 0.05);
  EXPECT_LT(percentile(all.yaw, 95), 0.8);
}

INSTANTIATE_TEST_SUITE_P(rooms, twist_in_rooms,
                         testing::Values(std::pair{"office", &office},
                                         std::pair{"pillars", &pillars},
                                         std::pair{"busy_office", &busy_office}),
                         [](const auto& room) { return std::string(room.param.first); });

/// The root of the mean square distance of points from their true places in the world.
double rms(const driven_lidar& lidar, const std::vector<point>& points, const twist_2d& twist) {
  double sum = 0.0;
  int count = 0;
  const std::int64_t first_ns = points.front().time_ns;
  const pose_2d first = lidar.pose_at(first_ns);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const place truth = lidar.truth()[i];
    if (std::isnan(truth.x)) continue;
    const double seconds = static_cast<double>(points[i].time_ns - first_ns) * 1e-9;
    const place at = moved(first, moved(driven(twist, seconds), own_place(points[i])));
    sum += (at.x - truth.x) * (at.x - truth.x) + (at.y - truth.y) * (at.y - truth.y);
    ++count;
  }
  return std::sqrt(sum / count);
}

TEST(twist_estimator, deskewing_with_it_halves_the_error_of_the_points) {
  for (const auto around : {&office, &pillars, &busy_office}) {
    for (const double yaw_deg : {20.0, -45.0, 90.0, 180.0}) {
      const drive how = {.twist = {0.4, -0.1, yaw_deg * degree}};
      driven_lidar lidar(around(), how, 3);
      twist_estimator estimator;
      (void)estimator.add(lidar.revolution());
      const std::vector<point> points = lidar.revolution();
      const twist_estimate made = estimator.add(points);
      const double raw = rms(lidar, points, {});
      EXPECT_LT(rms(lidar, points, made.twist), 0.5 * raw) << yaw_deg;
    }
  }
}

TEST(twist_estimator, the_covariance_covers_the_errors) {
  for (const auto around : {&office, &pillars}) {
    for (const twist_2d& twist : {twist_2d{}, twist_2d{0.5, 0.0, 0.5}, twist_2d{0.3, 0.2, -1.5}}) {
      std::vector<double> squares;
      for (std::uint32_t seed = 1; seed <= 100; ++seed) {
        const twist_estimate made = estimate(
            around(), {.twist = twist, .start = {0.3 + 0.005 * seed, 0.4, 0.06 * seed}}, seed);
        ASSERT_TRUE(made.is_known());
        squares.push_back(normalised_square(made, twist));
      }
      // Of three normally distributed errors: half below 2.4, 95 of 100 below 7.8.
      EXPECT_LT(percentile(squares, 95), 9.0);
      EXPECT_GT(percentile(squares, 50), 1.2);
    }
  }
}

TEST(twist_estimator, has_a_larger_covariance_if_the_twist_was_not_constant) {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    const drive steady = {.twist = {0.0, 0.0, 0.5}};
    drive starting = {.twist = {}};
    starting.yaw_rad_per_s2 =
        3.5;  // a mean of 0.5 rad/s from the middle of one revolution to the next
    const double expected = estimate(office(), steady, seed).covariance[0];
    EXPECT_GT(estimate(office(), starting, seed).covariance[0], 100.0 * expected);
  }
}

TEST(twist_estimator, is_never_sure_of_a_wrong_twist) {
  // Beside a pillar, which hides half of the hall, and partly through it: the surfaces of both scans differ.
  int known = 0;
  for (drive how : many_drives()) {
    how.start = {-1.7, -1.35, 0.2};
    const twist_estimate made = estimate(pillars(), how, 1);
    if (!made.is_known()) continue;
    ++known;
    EXPECT_LT(error_of(made.twist, how.twist).speed, 0.1);
    EXPECT_LT(error_of(made.twist, how.twist).yaw, 2.0 * degree);
  }
  EXPECT_GT(known, 40);  // of 63
}

TEST(twist_estimator, does_not_know_the_speed_along_a_corridor) {
  for (const double yaw_deg : {0.0, 40.0, -90.0}) {
    for (const double speed : {0.0, 0.6, -1.0}) {
      for (std::uint32_t seed = 1; seed <= 10; ++seed) {
        const drive how = {.twist = {speed, 0.0, yaw_deg * degree}, .start = {1.0, 0.2, 0.0}};
        driven_lidar lidar(corridor(), how, seed);
        twist_estimator estimator;
        (void)estimator.add(lidar.revolution());
        const std::vector<point> points = lidar.revolution();
        const twist_estimate made = estimator.add(points);
        ASSERT_EQ(made.status, twist_status::degenerate);
        EXPECT_TRUE(made.known[2]);
        EXPECT_NEAR(made.twist.yaw_rad_per_s, how.twist.yaw_rad_per_s, 1.0 * degree);
        // Along the corridor, in the lidar's frame between the two revolutions.
        const double yaw = lidar.pose_at(points.front().time_ns).yaw_rad;
        const double c = std::cos(yaw);
        const double s = -std::sin(yaw);
        const auto& m = made.covariance;
        EXPECT_GT(c * c * m[0] + 2 * c * s * m[1] + s * s * m[4], 50.0);
        EXPECT_LT(s * s * m[0] - 2 * c * s * m[1] + c * c * m[4], 1.0);
        EXPECT_FALSE(made.known[0]);
        if (yaw_deg == 0.0) {
          EXPECT_TRUE(made.known[1]);
        }
      }
    }
  }
}

TEST(twist_estimator, keeps_the_last_value_of_what_it_does_not_know) {
  // From the office into the corridor, with the same times.
  driven_lidar first(office(), {.twist = {0.5, 0.0, 0.0}}, 1);
  driven_lidar second(corridor(), {.twist = {0.5, 0.0, 0.0}, .start = {0.0, 0.2, 0.0}}, 2);
  twist_estimator estimator;
  for (int i = 0; i < 3; ++i) {
    (void)estimator.add(first.revolution());
    (void)second.revolution();
  }
  (void)estimator.add(second.revolution());  // another place: nothing fits
  const twist_estimate made = estimator.add(second.revolution());
  EXPECT_EQ(made.status, twist_status::degenerate);
  EXPECT_NEAR(made.twist.x_m_per_s, 0.5, 0.1);
}

TEST(twist_estimator, knows_nothing_in_an_empty_hall) {
  for (const double outliers : {0.0, 0.03}) {
    const twist_estimate made =
        estimate(empty_hall(), {.twist = {0.5, 0.0, 0.5}, .outliers = outliers}, 1);
    EXPECT_EQ(made.status, twist_status::too_few_returns);
    EXPECT_THAT(made.known, testing::Each(false));
    EXPECT_GE(made.covariance[0], 100.0);
    EXPECT_GE(made.covariance[8], 100.0);
  }
}

TEST(twist_estimator, knows_no_rotation_in_a_round_room) {
  surroundings round;
  for (int i = 0; i < 720; ++i) {
    const double a = i * 0.5 * degree;
    const double b = (i + 1) * 0.5 * degree;
    round.walls.push_back(
        {3.0 * std::cos(a), 3.0 * std::sin(a), 3.0 * std::cos(b), 3.0 * std::sin(b)});
  }
  const twist_estimate made = estimate(round, {.twist = {0.0, 0.0, 0.5}, .start = {}}, 1);
  EXPECT_EQ(made.status, twist_status::degenerate);
  EXPECT_FALSE(made.known[2]);
}

}  // namespace
