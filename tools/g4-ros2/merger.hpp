// SPDX-License-Identifier: MIT
// Several lidars on one robot as one scan, in the frame of the robot.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "dds/bus.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/twist_estimator.hpp"
#include "io/scan_shaper.hpp"
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

  void add(std::size_t index, const shaped_scan& scan, const scan_times& when);
  [[nodiscard]] bool is_wanted() const { return messages_.is_wanted(); }
  [[nodiscard]] scan_messages& messages() noexcept { return messages_; }

 private:
  struct part {
    mounting place;
    std::vector<point> for_grid;
    std::vector<point> kept;
    std::int64_t end_ns = 0;
    std::optional<twist_estimator> estimator;
  };
  /// `which` of all parts, as one scan at `reference_ns`.
  [[nodiscard]] std::span<const point> merged_points(std::vector<point> part::* which,
                                                     std::int64_t reference_ns,
                                                     std::span<const stamped_pose> path,
                                                     std::vector<point>& out) const;
  void follow(part& leader, const scan_times& when);

  scan_messages messages_;
  std::unique_ptr<odometry_subscription> driven_;
  std::mutex mutex_;
  std::vector<part> parts_;
  odometry_path path_;
  std::optional<twist_2d> twist_;  // of the robot, by the scans
  std::vector<point> for_grid_;
  std::vector<point> kept_;
};

}  // namespace g4_tool
