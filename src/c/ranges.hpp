// SPDX-License-Identifier: MIT
// Options of grids and marks, of C as those of C++.
#pragma once

#include <g4lidar/c/filter.h>
#include <g4lidar/c/point.h>

#include <cstdint>
#include <optional>

#include "border.hpp"
#include "g4lidar/filter/outliers.hpp"
#include "g4lidar/filter/too_near.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/point.hpp"
#include "versioned_options.hpp"

namespace g4lidar::c {

inline constexpr g4lidar_grid_options grid_defaults{sizeof(g4lidar_grid_options),
                                                    G4LIDAR_ROBOT,
                                                    G4LIDAR_NEAREST,
                                                    false,
                                                    {},
                                                    G4LIDAR_NO_RETURN_AS_INFINITY,
                                                    0,
                                                    g4_model.turn_deg,
                                                    g4_model.range.max_mm};
inline constexpr g4lidar_outlier_options outlier_defaults{
    sizeof(g4lidar_outlier_options), 2, 1, 0.05F, -1.0F, 1, 5.0F, {}};
inline constexpr g4lidar_near_options near_defaults{sizeof(g4lidar_near_options), 0.0F, 3, {}};

[[nodiscard]] constexpr bool is_frame(int value) noexcept {
  return value == G4LIDAR_VENDOR || value == G4LIDAR_ROBOT;
}
[[nodiscard]] constexpr frame frame_of(int value) noexcept {
  return value == G4LIDAR_ROBOT ? frame::robot : frame::vendor;
}

/// Whether it is the turn of a model.
[[nodiscard]] constexpr bool is_turn(unsigned turn_deg) noexcept {
  return turn_deg == 0 || turn_deg == 180;
}

/// Nothing if a member has no valid value.
[[nodiscard]] inline std::optional<grid_options> grid_of(
    const g4lidar_grid_options& given) noexcept {
  const auto is_up_to = [](std::int32_t value, int most) { return value >= 0 && value <= most; };
  if (!is_up_to(given.frame, G4LIDAR_ROBOT) || !is_up_to(given.pick, G4LIDAR_MINIMUM) ||
      !is_up_to(given.no_return, G4LIDAR_NO_RETURN_AS_MAX) ||
      !is_up_to(given.near_is_minus_infinity, 1) || !is_turn(given.turn_deg) ||
      !(given.longest_range_mm > 0.0F)) {
    return std::nullopt;
  }
  return grid_options{given.frame == G4LIDAR_ROBOT ? frame::robot : frame::vendor,
                      given.pick == G4LIDAR_MINIMUM ? grid_pick::minimum : grid_pick::nearest,
                      given.keep_too_near,
                      static_cast<no_return_as>(given.no_return),
                      given.near_is_minus_infinity == 1,
                      static_cast<std::uint16_t>(given.turn_deg),
                      given.longest_range_mm};
}

/// Nothing if the options cannot be used; with NULL the defaults.
[[nodiscard]] inline std::optional<near_limits> near_of(
    const g4lidar_near_options* given) noexcept {
  g4lidar_near_options taken = near_defaults;
  if (!take_options(given, taken) || !(taken.shortest_mm >= 0.0F)) return std::nullopt;
  return near_limits{taken.shortest_mm, taken.revolutions};
}

struct outlier_limits {
  speckle_limits speckle;
  edge_limits edges;
};
/// The same.
[[nodiscard]] inline std::optional<outlier_limits> outliers_of(
    const g4lidar_outlier_options* given) noexcept {
  g4lidar_outlier_options taken = outlier_defaults;
  const auto is_window = [](std::uint32_t value) { return value >= 1 && value <= max_window; };
  if (!take_options(given, taken) || !is_window(taken.window) || !is_window(taken.edge_window) ||
      !(taken.least_angle_deg > 0.0F && taken.least_angle_deg <= 45.0F) ||
      !(taken.near_m >= 0.0F) || !(taken.near_ratio >= 0.0F || taken.near_ratio == -1.0F)) {
    return std::nullopt;
  }
  return outlier_limits{{taken.window, taken.near_count, taken.near_m, taken.near_ratio},
                        {taken.edge_window, taken.least_angle_deg}};
}

}  // namespace g4lidar::c
