// SPDX-License-Identifier: MIT
// Marks isolated returns and veiling points by their neighbours in the order of measurement.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "g4lidar/cartesian.hpp"
#include "g4lidar/core/angle.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar {

/// What comes before the first and after the last point.
enum class scan_ends : std::uint8_t {
  joined,  ///< A whole revolution: the first point follows the last one.
  open,    ///< A piece of a revolution: nothing is known there.
};

/// The greatest window of the functions below.
inline constexpr std::size_t max_window = 16;

/// Which returns are isolated: rain, dust, insects, bit errors. With the defaults, at 9000 samples
/// per second and 7 revolutions per second, an object that gives two returns in a row is kept, and
/// so is a wall at 10 degrees to the beam. An object that gives one return is marked: below 10 mm
/// of width per metre of distance an object may give one return only.
struct speckle_limits {
  /// How many samples on each side are neighbours: 1 to max_window; another number counts as the nearest.
  std::size_t window = 2;
  std::size_t count = 1;  ///< With fewer near neighbours than this a return is isolated.
  float near_m = 0.05F;   ///< Neighbours up to this distance are near; or up to
  /// this share of the range, if that is more. Negative: 0.05 where the samples are up to 0.28 degrees
  /// apart, as those of a G4 at 9 kHz and 7 Hz, and in proportion where they are farther apart: 0.15
  /// for an X2 at 7 Hz.
  float near_ratio = -1.0F;

  /// `near_ratio`, or that of samples which are so many degrees apart. *Pure.*
  [[nodiscard]] constexpr float near_ratio_at(float step_deg) const noexcept {
    constexpr float usual_deg = 0.28F;
    return near_ratio >= 0.0F ? near_ratio : 0.05F * std::max(1.0F, step_deg / usual_deg);
  }
};

/// Which returns are veiling points: the beam hit two surfaces, and the range is between them, where
/// nothing is. Such a point has a nearer neighbour on one side and a farther one on the other side,
/// and the lines to both make a small angle with the beam. At the edge of an object, where one side
/// only is steep, and on an object in front of everything beside it, nothing is marked. An object
/// that is at most `window` samples wide, and stands between a nearer one on one side and a farther
/// one on the other side, cannot be distinguished from veiling points and is marked.
struct edge_limits {
  std::size_t window = 1;  ///< As in speckle_limits.
  /// Below this angle between beam and line a neighbour is across a jump: above 0, at most 45; 0 and less
  /// mark nothing, and more counts as 45. Walls at a greater angle to the beam are kept. A veiling point is found if its distance from both
  /// surfaces is at least the distance between two samples there divided by the tangent: at 7 Hz and
  /// 9 kHz, and with 5 degrees, 5.6 % of the range of each surface.
  float least_angle_deg = 5.0F;
};

namespace detail {

/// The nearest window that there can be.
[[nodiscard]] constexpr std::size_t possible_window(std::size_t wanted) noexcept {
  return std::clamp<std::size_t>(wanted, 1, max_window);
}

/// Sets `mark` on the returns for which `is_marked(before, here, after, range_mm)` is true and clears
/// it on all other points. The places are those of a point and of the samples in the window on each
/// side, NaN where there is no sample or no return. Returns the number of marked points.
template <class Judge>
constexpr std::size_t mark_by_neighbours(std::span<point> points, std::size_t wanted_window,
                                         scan_ends ends, point_flags mark,
                                         Judge is_marked) noexcept {
  const std::size_t window = possible_window(wanted_window);
  const std::size_t size = points.size();
  // A sample would be its own neighbour.
  const bool joined = ends == scan_ends::joined && size > 2 * window;
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const auto place = [&](std::size_t k) {  // the place of sample `k` - window
    const bool is_beside = k < window || k >= window + size;
    if (is_beside && !joined) return xy_point{nan, nan, 0};
    return to_xy(points[(k + (joined ? size : 0) - window) % size], frame::vendor);
  };
  // The places of 2 * window + 1 samples in a row, in memory for twice as many: when it is full, the
  // last ones move to its front.
  std::array<xy_point, 4 * max_window + 2> places;
  std::size_t from = 0;
  std::size_t known = 0;
  while (known < 2 * window) {
    places[known] = place(known);
    ++known;
  }
  std::size_t marked = 0;
  for (std::size_t i = 0; i < size; ++i, ++from) {
    if (known == places.size()) {
      std::copy(places.begin() + static_cast<std::ptrdiff_t>(from), places.end(), places.begin());
      known -= from;
      from = 0;
    }
    places[known++] = place(i + 2 * window);
    const std::span<const xy_point> here(&places[from], 2 * window + 1);
    point& p = points[i];
    const bool found = !p.is_no_return() && is_marked(here.first(window), here[window],
                                                      here.subspan(window + 1), p.range_mm);
    p.flags = found ? p.flags | mark : without(p.flags, mark);
    marked += found ? 1U : 0U;
  }
  return marked;
}

/// Copies `points` to the front of `out`, which may be the same memory.
constexpr std::span<point> copy_points(std::span<const point> points,
                                       std::span<point> out) noexcept {
  assert(out.size() >= points.size());
  if (out.data() != points.data()) std::copy(points.begin(), points.end(), out.begin());
  return out.first(points.size());
}

/// The mean angle between two samples in a row. Gaps, where packets were lost, do not count.
class mean_step {
 public:
  constexpr void add(const point& from, const point& to) noexcept {
    constexpr float longest_deg = 10.0F;
    float step_deg = to.angle_deg - from.angle_deg;
    if (step_deg < -180.0F) step_deg += 360.0F;
    if (step_deg > 180.0F) step_deg -= 360.0F;
    if (step_deg < -longest_deg || step_deg > longest_deg) return;
    sum_deg_ += step_deg;
    ++count_;
  }
  /// In degrees; 0 if it is not known.
  [[nodiscard]] constexpr float value() const noexcept {
    return count_ > 0 ? sum_deg_ / static_cast<float>(count_) : 0.0F;
  }

 private:
  float sum_deg_ = 0.0F;
  std::uint32_t count_ = 0;
};

/// That of `points`, in degrees.
constexpr float mean_step_deg(std::span<const point> points) noexcept {
  mean_step all;
  for (std::size_t i = 1; i < points.size(); ++i) all.add(points[i - 1], points[i]);
  return all.value();
}

}  // namespace detail

/// The angle between the samples of a stream: that of its last whole revolution, however the stream is
/// divided. *Never allocates.*
class sample_spacing {
 public:
  /// Until a revolution has passed it is that of the model at 7 revolutions per second.
  explicit constexpr sample_spacing(const model& model) noexcept
      : step_deg_(7.0F * 360.0F / static_cast<float>(first_rate_hz(model))) {}

  /// The next points of the stream, in the order of measurement.
  constexpr void add(std::span<const point> points) noexcept {
    for (const point& p : points) {
      if (p.revolution == last_.revolution) {
        now_.add(last_, p);
      } else {
        if (is_whole_ && now_.value() > 0.0F) step_deg_ = now_.value();
        is_whole_ = has_last_ && p.revolution == last_.revolution + 1;
        now_ = {};
      }
      last_ = p;
      has_last_ = true;
    }
  }
  /// In degrees.
  [[nodiscard]] constexpr float step_deg() const noexcept { return step_deg_; }

 private:
  float step_deg_;
  point last_;
  bool has_last_ = false;
  bool is_whole_ = false;  // whether the first point of the revolution has been seen
  detail::mean_step now_;  // of the revolution
};

/// Flags the returns that `limits` define as point_flags::isolated, clears that flag on all other
/// points, and returns the number of flagged ones. Linear in the number of points times the window.
/// It looks at places only, so other marks do not change the result. With at most twice the window
/// of points the ends are open. *Pure, never allocates.* To leave the flagged points out:
/// point_filter::excluded.
constexpr std::size_t mark_isolated(std::span<point> points, const speckle_limits& limits = {},
                                    scan_ends ends = scan_ends::joined) noexcept {
  const float near_ratio = limits.near_ratio_at(detail::mean_step_deg(points));
  const auto judge = [&limits, near_ratio](std::span<const xy_point> before, const xy_point& here,
                                           std::span<const xy_point> after, float range_mm) {
    const float near_m = std::max(limits.near_m, near_ratio * 0.001F * range_mm);
    std::size_t count = 0;
    for (const auto& side : {before, after}) {
      for (const xy_point& other : side) {
        const float dx = other.x_m - here.x_m;
        const float dy = other.y_m - here.y_m;
        count += dx * dx + dy * dy <= near_m * near_m ? 1U : 0U;
      }
    }
    return count < limits.count;
  };
  return detail::mark_by_neighbours(points, limits.window, ends, point_flags::isolated, judge);
}

/// The same on a copy of all `points` at the front of `out`, which is at least as long.
constexpr std::size_t mark_isolated(std::span<const point> points, std::span<point> out,
                                    const speckle_limits& limits,
                                    scan_ends ends = scan_ends::joined) noexcept {
  return mark_isolated(detail::copy_points(points, out), limits, ends);
}

/// The same for veiling points and point_flags::veiling.
constexpr std::size_t mark_veiling(std::span<point> points, const edge_limits& limits = {},
                                   scan_ends ends = scan_ends::joined) noexcept {
  const float least_deg = limits.least_angle_deg > 0.0F ? limits.least_angle_deg : 0.0F;
  const sine_cosine least = sine_cosine_deg(std::min(least_deg, 45.0F));
  const auto judge = [tangent = least.sine / least.cosine](std::span<const xy_point> before,
                                                           const xy_point& here,
                                                           std::span<const xy_point> after, float) {
    struct jumps {
      bool nearer = false;
      bool farther = false;
    };
    const auto jumps_to = [&](std::span<const xy_point> side) {
      jumps found;
      for (const xy_point& other : side) {
        const float dx = other.x_m - here.x_m;
        const float dy = other.y_m - here.y_m;
        // Along and across the beam, both times the range.
        const float along = dx * here.x_m + dy * here.y_m;
        const float across = dy * here.x_m - dx * here.y_m;
        const float widest = tangent * (along < 0.0F ? -along : along);
        const bool is_steep = (across < 0.0F ? -across : across) < widest;
        found.farther |= is_steep && along > 0.0F;
        found.nearer |= is_steep && along < 0.0F;
      }
      return found;
    };
    const jumps back = jumps_to(before);
    const jumps on = jumps_to(after);
    return (back.nearer && on.farther) || (back.farther && on.nearer);
  };
  return detail::mark_by_neighbours(points, limits.window, ends, point_flags::veiling, judge);
}

/// The same on a copy of all `points` at the front of `out`, which is at least as long.
constexpr std::size_t mark_veiling(std::span<const point> points, std::span<point> out,
                                   const edge_limits& limits,
                                   scan_ends ends = scan_ends::joined) noexcept {
  return mark_veiling(detail::copy_points(points, out), limits, ends);
}

}  // namespace g4lidar
