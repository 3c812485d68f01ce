// SPDX-License-Identifier: MIT
// Polygons in the plane, and whether a place is inside of one.
#pragma once

#include <cstddef>
#include <span>

#include "g4lidar/detail/cpp20.hpp"

namespace g4lidar {

/// A corner of a polygon: metres in frame::robot, x ahead and y to the left of the lidar.
struct corner {
  float x_m = 0.0F;
  float y_m = 0.0F;

  friend constexpr bool operator==(const corner&, const corner&) noexcept = default;
};

/// The corners in order, in either sense; the last one is joined to the first one. A view of the
/// caller's memory.
using polygon = std::span<const corner>;

/// Whether `position` is inside of `outline`. *Pure.* By the even-odd rule: what a self-crossing outline
/// goes round twice is outside. Of the edges, those at the left and at the bottom are inside (x to
/// the right, y up), those at the right and at the top are outside: of two polygons with a common
/// edge, exactly one contains a place on it. An outline with fewer than three corners, or with all
/// corners on one line, contains nothing; so does every outline for a coordinate that is NaN.
[[nodiscard]] constexpr bool is_inside(corner position, polygon outline) noexcept {
  bool inside = false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const corner& a = outline[i];
    const corner& b = outline[i + 1 == outline.size() ? 0 : i + 1];
    const bool a_is_above = a.y_m > position.y_m;
    if (a_is_above == (b.y_m > position.y_m)) continue;
    // The edge always in the same sense, so that it rounds in the same way for both its polygons.
    const corner& low = a_is_above ? b : a;
    const corner& high = a_is_above ? a : b;
    const double across =
        static_cast<double>(high.x_m - low.x_m) * static_cast<double>(position.y_m - low.y_m);
    const double along =
        static_cast<double>(position.x_m - low.x_m) * static_cast<double>(high.y_m - low.y_m);
    if (along < across) inside = !inside;  // the edge is to the right of `at`
  }
  return inside;
}

}  // namespace g4lidar
