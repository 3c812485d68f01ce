// SPDX-License-Identifier: MIT
// Several lidars on one robot as one scan, in the frame of the robot.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/named_sources.hpp"
#include "deskew_report.hpp"
#include "g4lidar/diagnostics/diagnostic_message.hpp"
#include "g4lidar/merge.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/odometry_path.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan_shaper.hpp"

namespace g4_tool {

/// When a revolution was measured, in nanoseconds.
struct scan_times {
  std::int64_t first_ns = 0;     ///< Of its first point, by the clock of the points.
  std::int64_t duration_ns = 0;  ///< Until the first point of the next one.
  std::int64_t ahead_ns = 0;     ///< The wall clock minus the clock of the points.
};

/// How a robot moves: by a twist, or by the poses; without both that is not known.
struct robot_motion {
  std::optional<g4lidar::twist_2d> twist{};
  std::span<const g4lidar::stamped_pose> path{};
};

/// One scan of all lidars, at the time `when.first_ns`. Points that are deskewed have this time; all others have their own,
/// and are flagged not_deskewed if deskewing was wanted. Its model has the turn of a G4, the shortest and the longest range
/// of all, and intensities if one of them has. Valid during a call.
struct merged_scan {
  g4lidar::scan for_grid;  ///< See scan_shaper::for_grid().
  g4lidar::scan kept;      ///< See scan_shaper::kept(); empty if nobody wants it.
  std::span<const std::size_t>
      kept_of_each;  ///< So many points of `kept` are of each lidar, in order.
  scan_times when;
  robot_motion moved;
};

/// Takes the newest scan of each lidar, and joins all of them at each scan of the first one that works. *Any thread.*
class scan_merger {
 public:
  /// Adds odometry that is not that of add(); `ahead_ns` as in scan_times.
  using odometry_source = std::function<void(g4lidar::odometry_path& into, std::int64_t ahead_ns)>;
  using taker = std::function<void(const merged_scan&)>;

  /// Throws bad_value if there are too many. `where`: see deskew_report. `others`: for deskewing::by_path, as long as
  /// add() gives none.
  scan_merger(deskewing how, const std::vector<named_source>& lidars, const std::string& where,
              odometry_source others = {});

  /// The newest scan of a lidar, by a scan_shaper with `for_merging`. Calls `take` with the joined ones, if they are.
  void add(std::size_t index, g4lidar::scan_shaper& scan, const scan_times& when, bool wants_points,
           const taker& take);
  /// The robot's odometry.
  void add(const g4lidar::stamped_odometry& at);
  /// Of the merged scans; more if they are deskewed.
  [[nodiscard]] std::vector<std::function<g4lidar::diagnostic_status()>> reports();

 private:
  struct part {
    std::string name;
    g4lidar::mounting place;
    const g4lidar::model* model = &g4lidar::g4_model;
    std::vector<g4lidar::point> for_grid;
    std::vector<g4lidar::point> kept;
    std::int64_t end_ns = 0;
    std::uint64_t lost = 0;         // so many scans were published without it
    std::uint64_t lost_before = 0;  // as it was reported
  };
  /// By the leading lidar, at the end of its scan.
  [[nodiscard]] robot_motion motion_of_robot(const part& leader, const g4lidar::scan_shaper& scan,
                                             const scan_times& when);
  /// What measures merged scans: see merged_scan.
  [[nodiscard]] g4lidar::model merged_model() const;
  /// `which` of all parts, as one scan at `reference_ns`.
  [[nodiscard]] g4lidar::merged merged_points(std::vector<g4lidar::point> part::* which,
                                              std::int64_t reference_ns, const robot_motion& moved,
                                              std::vector<g4lidar::point>& out) const;
  [[nodiscard]] g4lidar::diagnostic_status status();

  deskewing deskew_;
  odometry_source others_;
  std::unique_ptr<deskew_report> report_;  // null if it does not deskew
  std::mutex mutex_;
  std::vector<part> parts_;
  g4lidar::odometry_path path_;
  bool has_odometry_ = false;  // of the robot itself
  std::uint64_t scans_ = 0;
  std::vector<g4lidar::point> for_grid_;
  std::vector<g4lidar::point> kept_;
  std::vector<std::size_t> kept_of_each_;
};

}  // namespace g4_tool
