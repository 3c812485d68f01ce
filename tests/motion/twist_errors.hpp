// SPDX-License-Identifier: MIT
// The error of an estimated twist.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "g4lidar/motion/twist_estimator.hpp"
#include "motion/driven_lidar.hpp"

namespace g4lidar::test {

inline constexpr double degree = std::numbers::pi / 180.0;

struct twist_error {
  double speed;  // m/s
  double yaw;    // rad/s
};
inline twist_error error_of(const twist_2d& made, const twist_2d& truth) {
  return {std::hypot(made.x_m_per_s - truth.x_m_per_s, made.y_m_per_s - truth.y_m_per_s),
          std::abs(made.yaw_rad_per_s - truth.yaw_rad_per_s)};
}

/// The value below which `percent` of all are.
inline double percentile(std::vector<double> all, std::size_t percent) {
  std::ranges::sort(all);
  return all[(all.size() - 1) * percent / 100];
}

/// The twist that the `count`-th scan gives.
inline twist_estimate estimate(const surroundings& around, const drive& how, std::uint32_t seed,
                               int count = 2) {
  driven_lidar lidar(around, how, seed);
  twist_estimator estimator;
  twist_estimate made;
  for (int i = 0; i < count; ++i)
    made = estimator.add(lidar.revolution(), static_cast<std::uint16_t>(how.turn_deg));
  return made;
}

/// e' inverse(C) e of the error of an estimate.
inline double normalised_square(const twist_estimate& made, const twist_2d& truth) {
  const auto& c = made.covariance;
  const double e[] = {made.twist.x_m_per_s - truth.x_m_per_s,
                      made.twist.y_m_per_s - truth.y_m_per_s,
                      made.twist.yaw_rad_per_s - truth.yaw_rad_per_s};
  const auto minor = [&](std::size_t i, std::size_t j) {
    const std::size_t a = (i + 1) % 3, b = (i + 2) % 3, d = (j + 1) % 3, f = (j + 2) % 3;
    return c[3 * a + d] * c[3 * b + f] - c[3 * a + f] * c[3 * b + d];
  };
  const double determinant = c[0] * minor(0, 0) + c[1] * minor(0, 1) + c[2] * minor(0, 2);
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) sum += e[i] * minor(i, j) / determinant * e[j];
  return sum;
}

}  // namespace g4lidar::test
