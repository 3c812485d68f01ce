// SPDX-License-Identifier: MIT
// Several lidars on one robot as one scan, on the topics of the robot.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "dds/bus.hpp"
#include "g4lidar/diagnostics/diagnostic_message.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "io/scan_merger.hpp"
#include "options.hpp"
#include "robot_messages.hpp"
#include "scan_messages.hpp"

namespace g4_tool {

/// Publishes what a scan_merger joins. *Any thread.*
class merger {
 public:
  /// Throws bad_value if there are too many. `on` and `options` outlive it.
  merger(dds::bus& on, const ros2_options& options, const std::vector<named_source>& lidars);

  /// The newest scan of a lidar, filled into grids with the options `grid`.
  void add(std::size_t index, scan_shaper& scan, const grid_options& grid, const scan_times& when);
  /// The robot's odometry, from now on instead of that which others publish.
  void add(const stamped_odometry& at) { scans_.add(at); }
  /// Of the merged scans; more if they are deskewed.
  [[nodiscard]] std::vector<std::function<diagnostic_status()>> reports() {
    return scans_.reports();
  }
  [[nodiscard]] bool is_wanted() const { return messages_.is_wanted(); }
  [[nodiscard]] scan_messages& messages() noexcept { return messages_; }

 private:
  scan_messages messages_;
  std::unique_ptr<odometry_subscription> driven_;
  scan_merger scans_;
};

}  // namespace g4_tool
