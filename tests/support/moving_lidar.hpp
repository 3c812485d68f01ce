// SPDX-License-Identifier: MIT
// Points of a moving lidar for the tests of deskewing.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar::test {

inline constexpr std::int64_t begin_ns = 5'000'000'000'000;

inline point at(float angle_deg, float range_mm, std::int64_t time_ns) {
  point p;
  p.angle_deg = angle_deg;
  p.range_mm = range_mm;
  p.time_ns = time_ns;
  p.revolution = 7;
  if (range_mm == 0.0F) p.flags = point_flags::no_return;
  if (range_mm > 0.0F && range_mm < 100.0F) p.flags = point_flags::too_near;
  return p;
}

/// Points as a G4 measures them at 9 kHz, with some pauses.
inline std::vector<point> some_points(std::mt19937& source, std::size_t count, double pauses) {
  std::uniform_real_distribution<float> degrees(0.0F, 360.0F);
  std::uniform_real_distribution<float> metres(0.0F, 1.0F);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  std::vector<point> points;
  std::int64_t time_ns = begin_ns;
  while (points.size() < count) {
    time_ns += 111'111;
    if (any(source) < pauses) time_ns += static_cast<std::int64_t>(any(source) * 2e9);
    const float part = metres(source);
    const float range_mm = part < 0.05F ? 0.0F : 16'000.0F * part * part;
    points.push_back(at(std::min(degrees(source), 359.99997F), range_mm, time_ns));
  }
  points.front().flags = points.front().flags | point_flags::revolution_start;
  return points;
}

inline mounting any_mounting(std::mt19937& source) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  return {{any(source), any(source), std::numbers::pi * any(source)}, source() % 2 == 0};
}

}  // namespace g4lidar::test
