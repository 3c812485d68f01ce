// SPDX-License-Identifier: MIT
// The options of a scan_shaper, and the files that it needs: --mask, --odometry, and recorded odometry.
#pragma once

#include <string>
#include <vector>

#include "cli/common_options.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/options/filter_text.hpp"
#include "g4lidar/scan_shaper.hpp"

namespace g4_tool {

/// g4lidar::load_mask(); - is standard input. Throws a failure that names the file and the line.
[[nodiscard]] g4lidar::mask mask_in(const std::string& path);

/// The options of `options` for filters, marks and deskewing, with the mask of its file. Views both.
[[nodiscard]] g4lidar::shaping_options shape_of(const common_options& options,
                                                const g4lidar::mask& loaded);

/// The poses in the file of that name, times ascending. Throws a failure that names the file and the line.
[[nodiscard]] std::vector<g4lidar::stamped_pose> load_odometry(const std::string& path);

/// The same with the velocities between them.
[[nodiscard]] std::vector<g4lidar::stamped_odometry> load_moving_odometry(const std::string& path);

/// g4lidar::recorded_odometry(). Throws a failure, or interrupted.
[[nodiscard]] std::vector<g4lidar::stamped_odometry> odometry_of_recording(const std::string& path);

}  // namespace g4_tool
