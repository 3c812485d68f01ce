// SPDX-License-Identifier: MIT
// What is left of a revolution: filtered, and deskewed by odometry or by the scans alone.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cli/common_options.hpp"
#include "g4lidar/export/mask.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/too_near.hpp"
#include "g4lidar/twist_estimator.hpp"

namespace g4_tool {

/// The newest poses of a robot, by its odometry.
class odometry_path {
 public:
  /// A pose that is not after the last one begins a new path.
  void add(const stamped_odometry& now);
  /// The poses, times ascending. If the last one is a little before `time_ns`, one more at that time, as if the
  /// robot had kept its velocity. Valid until the next call.
  [[nodiscard]] std::span<const stamped_pose> until(std::int64_t time_ns);
  [[nodiscard]] const std::optional<stamped_odometry>& newest() const noexcept { return newest_; }

 private:
  std::optional<stamped_odometry> newest_;
  std::vector<stamped_pose> poses_;
  bool is_last_guessed_ = false;
};

/// Views, valid until the next call of shape().
struct shaped_scan {
  std::span<const point> for_grid;  ///< For fill_grid(): see filter_for_grid().
  std::span<const point> kept;    ///< For a cloud. Deskewed points have the time of the first one.
  std::optional<twist_2d> twist;  ///< Of the lidar, if it was deskewed by the scans.
  grid_options grid{};            ///< How to fill the grid.
};

/// Filters and deskews the revolutions of one lidar. *Single thread.*
class scan_shaper {
 public:
  /// `how`: its filters, deskewing and mask. Throws a failure for a mask that cannot be read.
  scan_shaper(const common_options& how, const mounting& mount);

  /// Other filters from now on.
  void set_filters(const common_options& how);
  /// `path`: for deskewing by_path.
  [[nodiscard]] shaped_scan shape(const scan& whole, std::span<const stamped_pose> path);
  /// How many points could not be deskewed.
  [[nodiscard]] std::uint64_t not_deskewed() const noexcept { return not_deskewed_; }

 private:
  std::span<point> deskewed_points(std::span<point> points, std::int64_t reference_ns,
                                   std::span<const stamped_pose> path,
                                   const std::optional<twist_2d>& twist);

  common_options how_;
  mounting mount_;
  g4lidar::mask mask_;
  point_filter filter_;
  std::optional<twist_estimator> estimator_;
  near_history near_;
  std::vector<point> marked_;
  std::vector<point> for_grid_;
  std::vector<point> kept_;
  std::uint64_t not_deskewed_ = 0;
};

}  // namespace g4_tool
