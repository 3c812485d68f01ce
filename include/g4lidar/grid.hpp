// SPDX-License-Identifier: MIT
// A scan on a fixed grid of directions: always the same number of ranges, as SLAM requires.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "g4lidar/core/angle.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"

namespace g4lidar {

/// Which point determines the range of a bin when several fall into it.
enum class grid_pick : std::uint8_t {
  nearest,  ///< The point whose direction is nearest to the middle of the bin.
  minimum,  ///< The point with the smallest range.
};

/// What a direction without return becomes in a grid. That nothing came back does not mean that the way
/// is free: what is nearer than the shortest range (0.28 m at 9 kHz) may give no return either. See
/// filter/too_near.hpp.
enum class no_return_as : std::uint8_t {
  infinity,  ///< +infinity, as REP 117 has it for "no return within the range".
  nan,       ///< NaN: nothing is known.
  max,  ///< grid_options::longest_mm, the range_max of a LaserScan, for programs that want numbers.
};

/// How to fill a grid. The defaults are those of a ROS LaserScan that begins at -pi.
struct grid_options {
  /// In the robot's frame bin 0 is centred at -180 degrees, in the vendor's at 0; the next bins
  /// follow in the direction in which the angles of the frame grow.
  frame to = frame::robot;
  grid_pick pick = grid_pick::nearest;
  /// Whether points flagged too_near give their range. By default a bin with only such points is
  /// NaN: something was there, so +infinity would mark the way as free; but the distance is not
  /// reliable (it may be dust on the window), so a range would put an obstacle onto the robot. NaN
  /// does neither. A reliable return in the same bin takes precedence.
  bool keep_too_near = false;
  no_return_as no_return = no_return_as::infinity;
  /// Whether a direction flagged may_be_too_near is -infinity, as REP 117 has it for targets that are
  /// too near. By default it is NaN. Without mark_near() no direction has this flag.
  bool near_is_minus_infinity = false;
  /// model::turn_deg of the lidar, 0 or 180. With a scan, that of its model is used instead.
  std::uint16_t turn_deg = g4_model.turn_deg;
  /// What no_return_as::max is, in millimetres: where a filter leaves out what is farther, its limit. With a
  /// scan it is at most the longest range of its model by the manufacturer; 0: that one, without a scan a G4's.
  float longest_mm = 0.0F;

  /// The same options for a lidar like `model`. *Pure.*
  [[nodiscard]] constexpr grid_options with(const model& model) const noexcept {
    grid_options made = *this;
    made.turn_deg = model.turn_deg;
    const auto most_mm = static_cast<float>(model.range.max_mm);
    if (!(longest_mm > 0.0F && longest_mm < most_mm)) made.longest_mm = most_mm;
    return made;
  }
};

/// A number of bins that leaves few of them empty: four fifths of the samples of a revolution at
/// 10 Hz, 720 for a G4. *Pure.*
[[nodiscard]] constexpr std::uint32_t default_bins(const model& model) noexcept {
  return first_rate_hz(model) * 2 / 25;
}

/// The bin that contains a direction (clockwise degrees in [0, 360), as in a point) in a grid of
/// `bins` bins, and the distance from the middle of the bin. *Pure.* `turn_deg` as for bearing_deg().
struct grid_place {
  std::size_t bin;  ///< Below `bins`; 0 if there is no bin.
  float
      off_middle_deg;  ///< At most half a bin, plus rounding; of another number more than 360, or not a number.
};
[[nodiscard]] constexpr grid_place place_in_grid(
    float direction, frame to, std::size_t bins,
    std::uint16_t turn_deg = g4_model.turn_deg) noexcept {
  const float bearing = bearing_deg(direction, to, turn_deg);
  const float from_first = to == frame::robot ? wrap_once_deg(bearing + 180.0F) : bearing;
  const float width = 360.0F / static_cast<float>(bins);
  const std::size_t bin = detail::saturated<std::uint32_t>(from_first / width + 0.5F);
  const float off = from_first - static_cast<float>(bin) * width;
  return {bins == 0 ? 0 : bin % bins, off < 0.0F ? -off : off};
}

/// What a bin gets where nothing came back. *Pure.*
[[nodiscard]] constexpr float no_return_m(const grid_options& options) noexcept {
  using limits = std::numeric_limits<float>;
  const float longest_mm = options.longest_mm > 0.0F ? options.longest_mm : g4_model.range.max_mm;
  if (options.no_return == no_return_as::nan) return limits::quiet_NaN();
  return options.no_return == no_return_as::max ? longest_mm * 0.001F : limits::infinity();
}

/// Like fill_grid() below, of the points for which `takes(point, bin)` is true. `intensities` is empty,
/// or as long as `ranges_m`, and gets those of the points that determine the ranges, 0 where none does.
template <std::predicate<const point&, std::size_t> Takes>
constexpr void fill_grid(std::span<const point> points, std::span<float> ranges_m,
                         const grid_options& options, Takes takes,
                         std::span<float> intensities = {}) noexcept {
  points = points.first(ranges_m.empty() ? 0 : std::min(points.size(), std::size_t{1} << 24));
  intensities = intensities.first(std::min(intensities.size(), ranges_m.size()));
  // First each bin holds the index of its best point, which a float holds exactly; then the range.
  constexpr float nothing = -1.0F;
  for (float& slot : ranges_m) slot = nothing;
  // The higher value takes the bin. What a filter left out hides no-returns beside it.
  enum : std::uint8_t { no_return, perhaps_near, unusable, usable };
  const auto worth = [&](const point& p) {
    if (p.is_no_return()) return p.may_be_too_near() ? perhaps_near : no_return;
    return p.is_too_near() && !options.keep_too_near ? unusable : usable;
  };
  const auto place_of = [&](const point& p) {
    return place_in_grid(p.angle_deg, options.to, ranges_m.size(), options.turn_deg);
  };
  const auto better = [&](const point& p, float off, const point& than) {
    if (worth(p) != worth(than)) return worth(p) > worth(than);
    if (options.pick == grid_pick::minimum) return p.range_mm < than.range_mm;
    return off < place_of(than).off_middle_deg;
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const point& p = points[i];
    const grid_place place = place_of(p);
    const bool is_there = place.off_middle_deg <= 360.0F;  // its direction is one
    if (!is_there || !takes(p, place.bin)) continue;
    float& slot = ranges_m[place.bin];
    if (slot < 0.0F || better(p, place.off_middle_deg, points[static_cast<std::size_t>(slot)])) {
      slot = static_cast<float>(i);
    }
  }
  for (std::size_t bin = 0; bin < intensities.size(); ++bin) {
    const float slot = ranges_m[bin];
    intensities[bin] = 0.0F;
    if (slot < 0.0F) continue;
    intensities[bin] = static_cast<float>(points[static_cast<std::size_t>(slot)].intensity);
  }
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const auto value_of = [&](const point& p) {
    switch (worth(p)) {
      case no_return:
        return no_return_m(options);
      case perhaps_near:
        return options.near_is_minus_infinity ? -infinity : nan;
      case unusable:
        return nan;
      default:
        return p.range_mm * 0.001F;
    }
  };
  for (float& slot : ranges_m) {
    slot = slot < 0.0F ? nan : value_of(points[static_cast<std::size_t>(slot)]);
  }
}

/// Fills every bin of `ranges_m`, which is not empty: the range in metres; +infinity, or what
/// grid_options::no_return sets, if the sensor measured there and nothing came back (never instead of a
/// return); NaN if nothing is known, because the sensor did not measure there, or every return is too
/// near to be reliable, or mark_near() has flagged the direction. +infinity is not free space: what is
/// nearer than the shortest range may give no return. `intensities` is empty, or as long as `ranges_m`,
/// and gets those of the points that determine the ranges, 0 where none does. *Never allocates.* Points
/// without a direction, which is not a number or far beyond 360, are in no bin, and neither are those behind
/// the first 16,777,216. (protocol: Point packets, no return)
constexpr void fill_grid(std::span<const point> points, std::span<float> ranges_m,
                         const grid_options& options = {},
                         std::span<float> intensities = {}) noexcept {
  fill_grid(points, ranges_m, options, [](const point&, std::size_t) { return true; }, intensities);
}

/// The same for the points of a scan, turned as its model, which also has the longest range.
constexpr void fill_grid(const scan& source, std::span<float> ranges_m,
                         const grid_options& options = {},
                         std::span<float> intensities = {}) noexcept {
  fill_grid(source.points, ranges_m, options.with(*source.model), intensities);
}

}  // namespace g4lidar
