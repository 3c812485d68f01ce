// SPDX-License-Identifier: MIT
// Several lidars on one robot as one scan, in the frame of the robot.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "g4lidar/merge.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan_shaper.hpp"

namespace g4lidar {

/// How a robot moves: by a twist, or by the poses; without both that is not known.
struct robot_motion {
  std::optional<twist_2d> twist{};
  std::span<const stamped_pose> path{};
};

/// One scan of all lidars, at the time `reference_ns`. Points that are deskewed have this time; all others have their own,
/// and are flagged not_deskewed if deskewing was wanted. Its model has the turn of a G4, the shortest and the longest range
/// of all, and intensities if one of them has, and is valid as long as the merger. Valid until the next one.
struct merged_scan {
  scan for_grid;  ///< See scan_shaper::for_grid().
  scan kept;      ///< See scan_shaper::kept(); empty if nobody wants it.
  std::span<const std::size_t>
      kept_of_each;  ///< So many points of `kept` are of each lidar, in order.
  std::int64_t reference_ns = 0;
  robot_motion moved{};
  std::size_t outside = 0;  ///< So many points of for_grid have no known motion.
};

/// Takes the newest scan of each lidar, and joins all of them at each scan of the first one that works. *Single thread*,
/// but for status().
class scan_merger {
 public:
  struct merged_lidar {
    std::string name;
    mounting place;
  };
  /// The poses of the robot until a time; empty: they are not known.
  using path_until = std::function<std::span<const stamped_pose>(std::int64_t)>;

  explicit scan_merger(deskewing deskewing, const std::vector<merged_lidar>& lidars);

  /// The newest scan of a lidar, by a scan_shaper with `for_merging`, whose first point is of `first_ns`. The joined ones,
  /// if they are.
  [[nodiscard]] std::optional<merged_scan> add(std::size_t index, scan_shaper& shaper,
                                               std::int64_t first_ns, std::int64_t duration_ns,
                                               bool wants_kept, const path_until& path);
  /// How many scans lacked a lidar; a warning if there were more since the last call. *Single thread*, another one.
  [[nodiscard]] diagnostic_status status();

 private:
  struct part {
    std::string name;
    mounting place;
    const g4lidar::model* model = &g4_model;
    std::vector<point> for_grid;
    std::vector<point> kept;
    std::int64_t end_ns = 0;
    std::atomic<std::uint64_t> lost = 0;  // so many scans were published without it
    std::uint64_t lost_before = 0;        // as it was reported
  };
  /// By the leading lidar, at the end of its scan.
  [[nodiscard]] robot_motion motion_of_robot(const part& leader, const scan_shaper& shaper,
                                             const path_until& path) const;
  /// What measures merged scans: see merged_scan.
  [[nodiscard]] const g4lidar::model& merged_model();
  /// Such points of all parts, as one scan at `reference_ns`.
  [[nodiscard]] merged merged_points(std::vector<point> part::* member, std::int64_t reference_ns,
                                     const robot_motion& moved, std::vector<point>& out) const;

  deskewing deskew_;
  std::deque<part> parts_;
  std::deque<g4lidar::model> models_;  // each stays valid; the last one is that of the newest scan
  std::atomic<std::uint64_t> scans_ = 0;
  std::vector<point> for_grid_;
  std::vector<point> kept_;
  std::vector<std::size_t> kept_of_each_;
};

}  // namespace g4lidar
