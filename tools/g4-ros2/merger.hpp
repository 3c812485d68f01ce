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

#include "dds/bus.hpp"
#include "g4lidar/diagnostics/diagnostic_message.hpp"
#include "g4lidar/merge.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "io/deskew_report.hpp"
#include "io/odometry_feed.hpp"
#include "options.hpp"
#include "robot_messages.hpp"
#include "scan_messages.hpp"

namespace g4_tool {

/// Takes the newest scan of each lidar, and publishes all of them together at each scan of the first one that
/// works. *Any thread.*
class merger {
 public:
  /// Throws bad_value if there are too many. `on` and `options` outlive it.
  merger(dds::bus& on, const ros2_options& options, const std::vector<named_source>& lidars);

  /// The newest scan of a lidar, filled into grids with the options `grid`.
  void add(std::size_t index, scan_shaper& scan, const grid_options& grid, const scan_times& when);
  /// The robot's odometry, from now on instead of that which others publish.
  void add(const stamped_odometry& at);
  /// Of the merged scans; more if they are deskewed.
  [[nodiscard]] std::vector<std::function<diagnostic_status()>> reports();
  [[nodiscard]] bool is_wanted() const { return messages_.is_wanted(); }
  [[nodiscard]] scan_messages& messages() noexcept { return messages_; }

 private:
  struct part {
    std::string name;
    mounting place;
    const g4lidar::model* model = &g4_model;
    std::vector<point> for_grid;
    std::vector<point> kept;
    std::int64_t end_ns = 0;
    std::uint64_t lost = 0;         // so many scans were published without it
    std::uint64_t lost_before = 0;  // as it was reported
  };
  /// How the robot moves: by a twist, or by the poses; without both that is not known.
  struct motion {
    std::optional<twist_2d> twist;
    std::span<const stamped_pose> path;
  };
  /// By the leading lidar, at the end of its scan.
  [[nodiscard]] motion motion_of_robot(const part& leader, const scan_shaper& scan,
                                       const scan_times& when);
  /// What measures merged scans: it is turned as merge_scans() turns points, and has the ranges of all parts.
  [[nodiscard]] g4lidar::model merged_model() const;
  /// `which` of all parts, as one scan at `reference_ns`.
  [[nodiscard]] merged merged_points(std::vector<point> part::* which, std::int64_t reference_ns,
                                     const motion& moved, std::vector<point>& out) const;
  [[nodiscard]] diagnostic_status status();

  scan_messages messages_;
  std::unique_ptr<odometry_subscription> driven_;
  deskewing deskew_;
  std::unique_ptr<deskew_report> report_;  // null if it does not deskew
  std::mutex mutex_;
  std::vector<part> parts_;
  odometry_path path_;
  bool has_odometry_ = false;  // of the robot itself
  std::uint64_t scans_ = 0;
  std::vector<point> for_grid_;
  std::vector<point> kept_;
};

}  // namespace g4_tool
