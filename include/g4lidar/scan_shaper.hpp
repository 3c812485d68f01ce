// SPDX-License-Identifier: MIT
// The scans of one lidar, marked, filtered and deskewed: each product is made once, and only if it is taken.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "g4lidar/core/angle.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/filter.hpp"
#include "g4lidar/filter/outliers.hpp"
#include "g4lidar/filter/too_near.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/motion/twist_estimator.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"

namespace g4lidar {

/// How a scan_shaper knows the motion by which it deskews.
enum class deskewing : std::uint8_t {
  none,      ///< It does not deskew.
  by_path,   ///< From the poses of the robot, its odometry.
  by_scans,  ///< From a twist_estimator.
};

/// Which points are marked by their neighbours or by earlier revolutions: those whose limits are given.
struct mark_limits {
  std::optional<speckle_limits> speckle{};  ///< By mark_isolated(); such points are left out.
  std::optional<edge_limits> edges{};       ///< By mark_veiling(); such points are left out.
  std::optional<near_limits> near{};        ///< By mark_near(); such points stay.

  /// How many samples on each side determine the marks of a point; 0 without `speckle` and `edges`. *Pure.*
  [[nodiscard]] constexpr std::size_t window() const noexcept {
    return std::max(speckle ? detail::possible_window(speckle->window) : 0,
                    edges ? detail::possible_window(edges->window) : 0);
  }
  /// Marks by neighbours: all that is given but `near`. *Never allocates.*
  constexpr void mark_by_neighbours(std::span<point> points, scan_ends ends) const noexcept {
    if (speckle) mark_isolated(points, *speckle, ends);
    if (edges) mark_veiling(points, *edges, ends);
  }
};

/// What a scan_shaper does. By default it changes nothing.
struct shaping_options {
  point_filter filter{};  ///< Which points are kept.
  mark_limits marks{};
  deskewing deskew = deskewing::none;
  mounting mount{};  ///< Of the lidar on the robot, for deskewing::by_path.
  /// Whether deskewed points get the time to which they were deskewed: for messages whose readers would deskew them
  /// again. Points flagged not_deskewed keep theirs.
  bool restamps = false;
  /// Whether points stay where they were measured, because merge_scans() deskews them. With deskewing::by_scans the
  /// twist is estimated nevertheless.
  bool for_merging = false;
};

/// Marks, filters and deskews the scans of one lidar, in this order:
///
///  1. mark_near(), mark_isolated() and mark_veiling() flag points, and twist_estimator estimates the motion, both
///     from all points as they were measured.
///  2. The filter leaves points out.
///  3. deskew() moves what is left to where it would have been seen at the time of the scan's first point. In a
///     direction in which the motion is not known, the value of the last estimate is used.
///
/// Points whose motion is not known stay where they are, are flagged not_deskewed, and are counted. *Single thread.*
/// Allocates when a scan has more points than those before, and throws only what std::vector throws.
///
///     scan_shaper shaper({.marks = {.speckle = speckle_limits{}}, .deskew = deskewing::by_scans});
///     auto scans = lidar->scans(500ms);
///     for (const scan& each : scans) {
///       shaper.shape(each);
///       fill_grid(shaper.for_grid(), ranges_m);
///       use(ranges_m);
///     }
///     return report(*scans.why_ended());
class G4LIDAR_API scan_shaper {
 public:
  /// Copies what the filter views.
  explicit scan_shaper(const shaping_options& options = {});

  /// Other options from the next scan on. Copies what the filter views. What mark_near() and the estimator know of
  /// earlier scans stays, as long as `marks.near` and deskewing::by_scans are set.
  void set_options(const shaping_options& options);

  /// The next scan, or piece of one, in order, and for deskewing::by_path the poses of the robot, times ascending.
  /// Both are views of the caller's memory, valid until the next call. Call it for each scan, although nobody may take
  /// its points: only what depends on earlier scans is done here.
  void shape(const scan& source, std::span<const stamped_pose> path = {});

  /// The scan with the points that the filter keeps. Made by the first call; a view, valid until the next shape().
  [[nodiscard]] scan kept();
  /// The same for fill_grid(): see filter_for_grid().
  [[nodiscard]] scan for_grid();
  /// The twist of the lidar's own frame by deskewing::by_scans, in m/s and rad/s; nothing if it is not known.
  [[nodiscard]] const std::optional<twist_2d>& twist() const noexcept { return twist_; }
  /// How many points of the scan, filtered or not, have no known motion; 0 if it does not deskew.
  [[nodiscard]] std::size_t outside() const noexcept { return outside_; }
  /// The sum of outside() over all scans.
  [[nodiscard]] std::uint64_t points_not_deskewed() const noexcept { return not_deskewed_; }
  /// The filter, which also leaves out the points that are marked. Valid until set_options().
  [[nodiscard]] const point_filter& filter() const noexcept { return options_.filter; }

 private:
  struct product {
    std::vector<point> memory;
    std::optional<std::span<const point>> points;  // if they were made
  };
  using filtering = std::span<point>(std::span<const point>, const point_filter&,
                                     std::span<point>) noexcept;
  [[nodiscard]] bool deskews() const noexcept;
  [[nodiscard]] std::size_t count_outside() const noexcept;
  [[nodiscard]] std::span<const point> points_of(product& wanted, filtering* filtered);
  [[nodiscard]] scan make(product& wanted, filtering* filtered);

  shaping_options options_;
  std::vector<sector> sectors_;  // of the filter, as the next ones
  std::vector<std::vector<corner>> corners_;
  std::vector<polygon> masks_;
  std::optional<twist_estimator> estimator_;
  near_history near_;
  scan source_;               // its points have the flags that marked_ names
  bool needs_marks_ = false;  // by neighbours
  std::span<const stamped_pose> path_;
  std::optional<twist_2d> twist_;
  std::vector<point> marked_;
  product kept_;
  product for_grid_;
  std::size_t outside_ = 0;
  std::uint64_t not_deskewed_ = 0;
};

/// The poses of the last 5 s, for scan_shaper::shape(). *Single thread.* Throws only what std::vector throws.
class G4LIDAR_API odometry_path {
 public:
  /// A pose that is not after the last one begins a new path.
  void add(const stamped_odometry& now);
  /// The poses, times ascending. If the last one is at most 0.2 s before `time_ns`, one more at that time, as if the
  /// robot had kept its velocity. Valid until the next call.
  [[nodiscard]] std::span<const stamped_pose> until(std::int64_t time_ns);
  /// The last one that was added.
  [[nodiscard]] const std::optional<stamped_odometry>& newest() const noexcept { return newest_; }

 private:
  std::optional<stamped_odometry> newest_;
  std::vector<stamped_pose> poses_;
  bool is_last_guessed_ = false;
};

}  // namespace g4lidar
