// SPDX-License-Identifier: MIT
// Points as Eigen matrices: the same memory, correctly transformed, without an allocation.

#include <cstddef>

namespace eigen_check {
std::size_t complaints = 0;
void complain() { ++complaints; }
}  // namespace eigen_check

// Eigen asserts that it does not allocate while this is set; in release builds, too.
#define EIGEN_RUNTIME_NO_MALLOC
#define eigen_assert(condition) ((condition) ? static_cast<void>(0) : eigen_check::complain())
#include "g4lidar/eigen.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <numbers>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace {
std::size_t news = 0;
}  // namespace

// The other forms use these two.
void* operator new(std::size_t size) {
  ++news;
  if (void* const memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  ++news;
  const auto unit = static_cast<std::size_t>(alignment);
  if (void* const memory = std::aligned_alloc(unit, (size + unit) / unit * unit)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace g4lidar {
namespace {

point at(float angle_deg, float range_mm) {
  point p;
  p.angle_deg = angle_deg;
  p.range_mm = range_mm;
  p.time_ns = static_cast<std::int64_t>(angle_deg);
  if (range_mm == 0.0F) p.flags = point_flags::no_return;
  return p;
}

std::vector<point> some_points() {
  std::vector<point> points;
  for (int i = 0; i < 100; ++i) {
    points.push_back(at(static_cast<float>(i) * 3.6F, static_cast<float>(i % 9 == 0 ? 0 : i * 40)));
  }
  return points;
}

std::vector<xy_point> some_xy(frame to) {
  const std::vector<point> points = some_points();
  std::vector<xy_point> xy(points.size());
  to_xy(points, to, xy);
  return xy;
}

/// The number of allocations in `work`, by operator new and by Eigen.
template <class Work>
std::size_t allocations_in(Work&& work) {
  news = 0;
  eigen_check::complaints = 0;
  Eigen::internal::set_is_malloc_allowed(false);
  work();
  Eigen::internal::set_is_malloc_allowed(true);
  return news + eigen_check::complaints;
}

TEST(EigenMaps, ShowThePointsInPlace) {
  std::vector<point> points = some_points();
  const auto map = polar_map(points);
  ASSERT_EQ(map.rows(), 2);
  ASSERT_EQ(map.cols(), 100);
  EXPECT_EQ(map.data(), &points[0].angle_deg);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    EXPECT_EQ(&map.coeffRef(0, column), &points[i].angle_deg);
    EXPECT_EQ(&map.coeffRef(1, column), &points[i].range_mm);
  }
  points[7].range_mm = 4321.0F;
  EXPECT_EQ(map(1, 7), 4321.0F);
}

TEST(EigenMaps, AreWritableForMutablePoints) {
  std::vector<xy_point> xy = some_xy(frame::robot);
  auto map = xy_map(xy);
  ASSERT_EQ(map.cols(), 100);
  EXPECT_EQ(map.data(), &xy[0].x_m);
  map.col(3) << 7.0F, 8.0F;
  EXPECT_EQ(xy[3].x_m, 7.0F);
  EXPECT_EQ(xy[3].y_m, 8.0F);
  EXPECT_EQ(xy[3].time_ns, some_points()[3].time_ns);

  const auto fixed = xy_map(std::as_const(xy));
  static_assert(!std::is_assignable_v<decltype(fixed(0, 0)), float>);
  EXPECT_EQ(fixed.data(), &xy[0].x_m);
  EXPECT_EQ(fixed(1, 3), 8.0F);
  std::array<xy_point, 2> two{};
  EXPECT_EQ(xy_map(two).cols(), 2);
  EXPECT_EQ(xy_map(std::span(two)).data(), &two[0].x_m);
}

TEST(EigenMaps, NoPoints_NoColumns) {
  EXPECT_EQ(polar_map(std::span<const point>()).cols(), 0);
  EXPECT_EQ(xy_map(std::span<xy_point>()).cols(), 0);
}

TEST(EigenMaps, WorkInExpressions) {
  const std::vector<point> points = some_points();
  const auto map = polar_map(points);
  EXPECT_FLOAT_EQ(map.row(1).maxCoeff(), 98 * 40.0F);
  const Eigen::Matrix2Xf metres = map * 0.001F;
  EXPECT_FLOAT_EQ(metres(1, 50), 2.0F);
}

TEST(EigenXy, AgreesWithToXyInBothFrames) {
  const std::vector<point> points = some_points();
  for (const frame to : {frame::robot, frame::vendor}) {
    Eigen::Matrix2Xf matrix(2, 100);
    to_xy(points, to, matrix);
    const std::vector<xy_point> expected = some_xy(to);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      if (points[i].is_no_return()) {
        EXPECT_TRUE(std::isnan(matrix(0, column)) && std::isnan(matrix(1, column)));
        continue;
      }
      EXPECT_EQ(matrix(0, column), expected[i].x_m);
      EXPECT_EQ(matrix(1, column), expected[i].y_m);
    }
  }
}

TEST(EigenConversion, AScan_IsTurnedAsItsModel) {
  const std::vector<point> points{{.angle_deg = 90.0F, .range_mm = 2000.0F}};
  Eigen::Matrix2Xf matrix(2, 1);
  to_xy(scan{.points = points, .model = model_named("x4")}, frame::robot, matrix);
  EXPECT_NEAR(matrix(1, 0), -2.0F, 1e-6F);
  to_xy(points, frame::robot, matrix);
  EXPECT_NEAR(matrix(1, 0), 2.0F, 1e-6F);
}

TEST(EigenTransform, RotatesAndTranslates) {
  // The lidar is 0.2 m in front of the robot's centre and 0.1 m to its left, rotated left by 90
  // degrees: a target 2 m ahead of it is 2 m to the robot's left.
  Eigen::Isometry2f place = Eigen::Isometry2f::Identity();
  place.translate(Eigen::Vector2f(0.2F, 0.1F));
  place.rotate(std::numbers::pi_v<float> / 2);
  std::vector<xy_point> points{{2.0F, 0.0F, 11}, {0.0F, 1.0F, 12}, {0.0F, 0.0F, 13}};
  transform(place, points);
  EXPECT_NEAR(points[0].x_m, 0.2F, 1e-6F);
  EXPECT_NEAR(points[0].y_m, 2.1F, 1e-6F);
  EXPECT_NEAR(points[1].x_m, -0.8F, 1e-6F);
  EXPECT_NEAR(points[1].y_m, 0.1F, 1e-6F);
  EXPECT_NEAR(points[2].x_m, 0.2F, 1e-6F);
  EXPECT_NEAR(points[2].y_m, 0.1F, 1e-6F);
  EXPECT_EQ(points[0].time_ns, 11);
  EXPECT_EQ(points[2].time_ns, 13);
}

TEST(EigenTransform, KeepsDistancesAndNaN) {
  Eigen::Isometry2f motion = Eigen::Isometry2f::Identity();
  motion.rotate(0.7F).pretranslate(Eigen::Vector2f(-3.0F, 5.0F));
  const std::vector<xy_point> before = some_xy(frame::robot);
  std::vector<xy_point> after = before;
  transform(motion, after);
  for (std::size_t i = 2; i < before.size(); ++i) {
    if (std::isnan(before[i].x_m)) {
      EXPECT_TRUE(std::isnan(after[i].x_m) && std::isnan(after[i].y_m));
      continue;
    }
    const auto from_first = [i](const std::vector<xy_point>& all) {
      return std::hypot(all[i].x_m - all[1].x_m, all[i].y_m - all[1].y_m);
    };
    EXPECT_NEAR(from_first(after), from_first(before), 1e-5F);
  }
  transform(motion.inverse(), after);
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (std::isnan(before[i].x_m)) continue;
    EXPECT_NEAR(after[i].x_m, before[i].x_m, 1e-5F);
    EXPECT_NEAR(after[i].y_m, before[i].y_m, 1e-5F);
  }
}

TEST(EigenAllocation, MapsAndTransformsNeverAllocate) {
  const std::vector<point> points = some_points();
  std::vector<xy_point> xy = some_xy(frame::robot);
  Eigen::Matrix2Xf matrix(2, 100);
  Eigen::Isometry2f motion = Eigen::Isometry2f::Identity();
  motion.rotate(0.3F);
  float sum = 0.0F;
  const std::size_t allocations = allocations_in([&] {
    sum += polar_map(points).row(1).sum();
    to_xy(points, frame::robot, matrix);
    transform(motion, xy);
    transform(motion, xy);
    sum += xy_map(xy)(0, 1) + matrix(0, 1);
    xy_map(xy) *= 2.0F;
  });
  EXPECT_EQ(allocations, 0U);
  EXPECT_FALSE(std::isnan(sum));
  // The counter works.
  EXPECT_NE(allocations_in([&] { matrix = Eigen::Matrix2Xf::Zero(2, 200); }), 0U);
  EXPECT_NE(allocations_in([&] { xy.reserve(1000); }), 0U);
}

}  // namespace
}  // namespace g4lidar
