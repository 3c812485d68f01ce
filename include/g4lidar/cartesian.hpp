// SPDX-License-Identifier: MIT
// Points as x and y in either frame of reference, without libm.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "g4lidar/core/angle.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"

namespace g4lidar {

/// A point in Cartesian coordinates, 16 bytes. Both coordinates are NaN for a point without return,
/// so that the points of a scan keep their indices.
struct xy_point {
  float x_m;
  float y_m;
  std::int64_t time_ns;  ///< As in the point.
};
static_assert(sizeof(xy_point) == 16);

/// `p` in frame `to`: vendor, x at 0 degrees and y at 90 degrees clockwise; robot, x forward and y to
/// the left. `turn_deg` is that of the model, 0 or 180; the default is the G4's. *Pure.* Within 2e-7
/// of the range. (protocol: Frames of reference)
[[nodiscard]] constexpr xy_point to_xy(const point& p, frame to,
                                       std::uint16_t turn_deg = g4_model.turn_deg) noexcept {
  if (p.is_no_return()) {
    constexpr float nowhere = std::numeric_limits<float>::quiet_NaN();
    return {nowhere, nowhere, p.time_ns};
  }
  const sine_cosine native = sine_cosine_deg(p.angle_deg);
  const float range_m = p.range_mm * 0.001F;
  const float x_m = range_m * native.cosine;
  const float y_m = range_m * native.sine;
  if (to == frame::vendor) return {x_m, y_m, p.time_ns};
  // The robot's bearing is 180 or 0 degrees minus the native angle: the sine is the same and the
  // cosine is negated, or the other way round.
  return turn_deg == 0 ? xy_point{x_m, -y_m, p.time_ns} : xy_point{-x_m, y_m, p.time_ns};
}

/// Writes all of `points` in frame `to` to the front of `out`, which is at least as long, and
/// returns what was written. *Pure.* `turn_deg` as above.
constexpr std::span<xy_point> to_xy(std::span<const point> points, frame to,
                                    std::span<xy_point> out,
                                    std::uint16_t turn_deg = g4_model.turn_deg) noexcept {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = to_xy(points[i], to, turn_deg);
  return out.first(points.size());
}

/// The same for the points of a scan, turned as its model.
constexpr std::span<xy_point> to_xy(const scan& source, frame to,
                                    std::span<xy_point> out) noexcept {
  return to_xy(source.points, to, out, source.model->turn_deg);
}

}  // namespace g4lidar
