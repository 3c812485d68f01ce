// SPDX-License-Identifier: MIT
// Selects points: range limits, a field of view, ignored sectors, polygons, flags.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "g4lidar/cartesian.hpp"
#include "g4lidar/core/angle.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/point.hpp"

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
    if (along < across) inside = !inside;  // the edge is to the right of `position`
  }
  return inside;
}

/// The directions from one angle to another, in the sense in which angles grow, both ends included.
/// It may contain the zero direction: 350 to 10 is 20 degrees wide.
class sector {
 public:
  /// Every direction.
  constexpr sector() noexcept = default;
  /// Degrees, any finite number of turns. If `to_deg` is 360 or more above `from_deg`, every
  /// direction; if both are equal, that one direction.
  constexpr sector(double from_deg, double to_deg) noexcept
      : everything_(to_deg - from_deg >= 360.0),
        from_(everything_ ? 0.0 : wrap_deg(from_deg)),
        to_(everything_ ? 360.0 : wrap_deg(to_deg)) {}

  /// Whether it contains every direction. *Pure.*
  [[nodiscard]] constexpr bool is_everything() const noexcept { return everything_; }
  /// Whether it contains `degrees`, in [0, 360). *Pure.*
  [[nodiscard]] constexpr bool has(double degrees) const noexcept {
    const bool is_from_on = degrees >= from_;
    const bool is_up_to = degrees <= to_;
    return from_ > to_ ? is_from_on || is_up_to : is_from_on && is_up_to;
  }

 private:
  bool everything_ = true;
  double from_ = 0.0;
  double to_ = 360.0;
};

/// Which points are kept: those that meet every condition. By default all points.
struct point_filter {
  /// The frame of the sectors: vendor, clockwise from the cable; or robot, counter-clockwise from
  /// straight ahead, where -90 to 90 is the front half.
  frame in = frame::vendor;
  /// model::turn_deg of the lidar, 0 or 180, for sectors in the robot's frame and for masks. A
  /// scan_shaper uses that of the scan's model instead.
  std::uint16_t turn_deg = g4_model.turn_deg;
  sector field_of_view{};  ///< Points in other directions are left out.
  std::span<const sector>
      ignored_sectors{};  ///< Points in one of them are left out. A view of the caller's memory.
  /// Returns inside of one of them are left out: parts of the robot. Always in frame::robot; a point
  /// without return has no place, and stays. A view of the caller's memory.
  std::span<const polygon> masks{};
  /// Limits of the range in millimetres, both included. A point without return has range 0, so it
  /// is left out where `least_range_mm` is above 0.
  float least_range_mm = 0.0F;
  float greatest_range_mm = std::numeric_limits<float>::infinity();
  bool returns_only = false;  ///< Points without return are left out.
  bool trusted_only = false;  ///< Points flagged too_near are left out.
  /// Points with one of these flags are left out: isolated | veiling after mark_isolated() and
  /// mark_veiling().
  point_flags excluded = point_flags::none;

  /// Whether the direction is in the field of view and in no ignored sector. *Pure.*
  [[nodiscard]] constexpr bool has_direction(const point& p) const noexcept {
    if (field_of_view.is_everything() && ignored_sectors.empty()) return true;
    const auto degrees = static_cast<double>(bearing_deg(p.angle_deg, in, turn_deg));
    if (!field_of_view.has(degrees)) return false;
    for (const sector& ignored : ignored_sectors) {
      if (ignored.has(degrees)) return false;
    }
    return true;
  }
  /// Whether the range is within the limits. *Pure.*
  [[nodiscard]] constexpr bool has_range(const point& p) const noexcept {
    return p.range_mm >= least_range_mm && p.range_mm <= greatest_range_mm;
  }
  /// Whether the place is inside of no mask. *Pure.*
  [[nodiscard]] constexpr bool has_place(const point& p) const noexcept {
    if (masks.empty() || p.is_no_return()) return true;
    const xy_point at = to_xy(p, frame::robot, turn_deg);
    for (const polygon& mask : masks) {
      if (is_inside({at.x_m, at.y_m}, mask)) return false;
    }
    return true;
  }
  /// Whether the point has no flag of `excluded`. *Pure.*
  [[nodiscard]] constexpr bool has_flags(const point& p) const noexcept {
    return (p.flags & excluded) == point_flags::none;
  }
  /// Whether there are range limits. *Pure.*
  [[nodiscard]] constexpr bool limits_ranges() const noexcept {
    return least_range_mm > 0.0F || greatest_range_mm < std::numeric_limits<float>::infinity();
  }
  /// Whether `p` is kept. *Pure.*
  [[nodiscard]] constexpr bool keeps(const point& p) const noexcept {
    return has_range(p) && has_flags(p) && has_direction(p) && has_place(p) &&
           !(returns_only && p.is_no_return()) && !(trusted_only && p.is_too_near());
  }
  /// Whether every point is kept. *Pure.*
  [[nodiscard]] constexpr bool keeps_everything() const noexcept {
    return field_of_view.is_everything() && ignored_sectors.empty() && masks.empty() &&
           !limits_ranges() && !returns_only && !trusted_only && excluded == point_flags::none;
  }
};

/// Copies the points that `filter` keeps, in their order, to the front of `out`, which is at least
/// as long as `points`, and returns them. `out` may begin where `points` begins, to filter in
/// place. *Pure, never allocates.*
constexpr std::span<point> filter_points(std::span<const point> points, const point_filter& filter,
                                         std::span<point> out) noexcept {
  assert(out.size() >= points.size());
  std::size_t count = 0;
  for (const point& p : points) {
    out[count] = p;
    count += filter.keeps(out[count]) ? 1U : 0U;
  }
  return out.first(count);
}

/// The same, in place.
constexpr std::span<point> filter_points(std::span<point> points,
                                         const point_filter& filter) noexcept {
  return filter_points(points, filter, points);
}

/// The same for fill_grid(), which must distinguish "no obstacle" from "not known". Points in
/// excluded directions are left out, so that their bins become NaN. A return that is left out for
/// its range, its place or a flag stays and is flagged too_near, so that its bin becomes NaN and not
/// empty. A return within range limits that the caller set loses that flag, even if it is near,
/// because the caller requested it.
/// Points without return stay. *Pure, never allocates.*
constexpr std::span<point> filter_for_grid(std::span<const point> points,
                                           const point_filter& filter,
                                           std::span<point> out) noexcept {
  assert(out.size() >= points.size());
  using enum point_flags;
  std::size_t count = 0;
  for (const point& p : points) {
    if (!filter.has_direction(p)) continue;
    point& kept = out[count++] = p;
    if (kept.is_no_return()) continue;
    if (!filter.has_range(kept) || !filter.has_place(kept) || !filter.has_flags(kept)) {
      kept.flags = kept.flags | too_near;
    } else if (filter.limits_ranges()) {
      kept.flags = without(kept.flags, too_near);
    }
  }
  return out.first(count);
}

}  // namespace g4lidar
