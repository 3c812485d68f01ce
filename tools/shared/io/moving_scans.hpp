// SPDX-License-Identifier: MIT
// The scans of a lidar on a robot that moves, with the place of the lidar at each of them.
#pragma once

#include <optional>

#include "cli/common_options.hpp"
#include "g4lidar/export/mask.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/odometry_feed.hpp"
#include "g4lidar/odometry_path.hpp"
#include "g4lidar/scan.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "g4lidar/sim/simulated_source.hpp"
#include "place_tracker.hpp"

namespace g4_tool {

/// Shapes scans as a scan_shaper, and follows the motion. With --deskew it is known by odometry or by the scans. Without
/// it the odometry of the source is used, if the source or --mount states where the lidar is on the robot: a wrong place
/// would be worse than none. *Single thread.*
class moving_scans {
 public:
  /// Loads the mask, and the odometry of a recording. Throws a failure. `restamps`: see shaping_options.
  explicit moving_scans(const common_options& options, bool restamps = false);

  /// The source was opened. `simulation`: that of source_reader.
  void open(g4lidar::lidar& device, const sim::simulated_source* simulation);
  /// The next scan, and what to do with the odometry that came with it.
  void add(const scan& source, const odometry_feed::taker& take = {});

  /// Of the last scan.
  [[nodiscard]] scan_shaper& shaper() noexcept { return shaper_; }
  /// Of the lidar's own frame (frame::robot) at the time of the scan's first point. Nothing if the motion is not known.
  [[nodiscard]] const std::optional<lidar_place>& place() const noexcept { return place_; }
  /// Whether the lidar has its top down: seen from above, its y axis points to the other side.
  [[nodiscard]] bool is_upside_down() const noexcept { return mount_.upside_down; }
  /// Whether the shaper deskews, with or without --deskew.
  [[nodiscard]] bool deskews() const noexcept { return deskew_ != deskewing::none; }

 private:
  void choose(const std::optional<mounting>& simulated);

  const common_options options_;
  const g4lidar::mask mask_;
  const bool restamps_;
  deskewing deskew_ = deskewing::none;
  mounting mount_;
  odometry_feed feed_;
  odometry_path path_;
  scan_shaper shaper_;
  place_tracker tracker_;
  std::optional<lidar_place> place_;
};

}  // namespace g4_tool
