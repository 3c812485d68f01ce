// SPDX-License-Identifier: MIT
// Points as Eigen matrices without a copy, and rigid transforms of them without an allocation.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cassert>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <ranges>
#include <span>
#include <type_traits>

#include "g4lidar/cartesian.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"

namespace g4lidar {

/// Columns of two floats, in an array of `Element`s.
template <class Element>
using column_map = Eigen::Map<
    std::conditional_t<std::is_const_v<Element>, const Eigen::Matrix2Xf, Eigen::Matrix2Xf>,
    Eigen::Unaligned, Eigen::OuterStride<sizeof(Element) / sizeof(float)>>;

/// An argument that owns its elements and is destroyed at the end of the call.
template <class T>
concept dying_range = std::ranges::contiguous_range<T> && !std::is_lvalue_reference_v<T> &&
                      !std::ranges::borrowed_range<std::remove_cvref_t<T>>;

/// The points as a 2 x N matrix, one column each: angle in degrees, range in millimetres. A map: it
/// is valid as long as the points and shows their changes.
[[nodiscard]] inline column_map<const point> polar_map(std::span<const point> points) noexcept {
  static_assert(std::is_standard_layout_v<point> && offsetof(point, angle_deg) == 0 &&
                offsetof(point, range_mm) == sizeof(float));
  return {reinterpret_cast<const float*>(points.data()), 2,
          static_cast<Eigen::Index>(points.size())};
}
template <dying_range Owner>
column_map<const point> polar_map(Owner&&) = delete;

/// An array of Cartesian points that outlives the call.
template <class T>
concept xy_range = std::ranges::contiguous_range<T> && !dying_range<T> &&
                   std::same_as<std::ranges::range_value_t<T>, xy_point>;

/// Cartesian points as a 2 x N matrix, one column each: x and y in metres. A map: it is valid as
/// long as the points and shows their changes; a map of mutable points is writable.
template <xy_range Points>
[[nodiscard]] auto xy_map(Points&& points) noexcept {
  using element = std::remove_reference_t<std::ranges::range_reference_t<Points>>;
  using coordinate = std::conditional_t<std::is_const_v<element>, const float, float>;
  static_assert(std::is_standard_layout_v<xy_point> && offsetof(xy_point, x_m) == 0 &&
                offsetof(xy_point, y_m) == sizeof(float));
  const std::span<element> columns(points);
  return column_map<element>(reinterpret_cast<coordinate*>(columns.data()), 2,
                             static_cast<Eigen::Index>(columns.size()));
}

/// Writes x and y in metres in frame `to` to the columns of `out`, which has one for each point.
/// Points without return become NaN. *Never allocates.* `turn_deg` is that of the model, 0 or 180.
inline void to_xy(std::span<const point> points, frame to, Eigen::Ref<Eigen::Matrix2Xf> out,
                  std::uint16_t turn_deg = g4_model.turn_deg) noexcept {
  assert(out.cols() == static_cast<Eigen::Index>(points.size()));
  for (Eigen::Index i = 0; i < out.cols(); ++i) {
    const xy_point xy = to_xy(points[static_cast<std::size_t>(i)], to, turn_deg);
    out.col(i) << xy.x_m, xy.y_m;
  }
}
/// The same for the points of a scan, turned as its model.
inline void to_xy(const scan& source, frame to, Eigen::Ref<Eigen::Matrix2Xf> out) noexcept {
  to_xy(source.points, to, out, source.model->turn_deg);
}

/// Transforms all points by `motion`: from the lidar's frame to the robot's, or from the robot's
/// frame to the world's. *Never allocates.* NaN stays NaN.
inline void transform(const Eigen::Isometry2f& motion, std::span<xy_point> points) noexcept {
  auto columns = xy_map(points);
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    const Eigen::Vector2f moved = motion * Eigen::Vector2f(columns.col(i));
    columns.col(i) = moved;
  }
}

}  // namespace g4lidar
