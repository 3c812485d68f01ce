// SPDX-License-Identifier: MIT
// The options of a scan_shaper and of parameters, and the files that it needs: --mask, --odometry, and recorded odometry.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "cli/common_options.hpp"
#include "g4lidar/export/mask.hpp"
#include "g4lidar/lidar_parameters.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/scan_shaper.hpp"

namespace g4_tool {

/// g4lidar::load_mask(); - is standard input. Throws a failure that names the file and the line.
[[nodiscard]] g4lidar::mask mask_in(const std::string& path);

/// The options of `how` for filters, marks and deskewing, with the mask of its file. Views both.
[[nodiscard]] g4lidar::shaping_options shape_of(const common_options& how,
                                                const g4lidar::mask& loaded);

/// The parameters of a lidar. `how`: the filters at the start; `words`: some of them as text. `shaper` shapes by them, for
/// messages of this lidar or for merging, and outlives them. Throws a failure for a mask that cannot be read.
[[nodiscard]] g4lidar::lidar_parameters parameters_of(
    const common_options& how, const std::map<std::string, std::string>& words, bool merges,
    g4lidar::scan_shaper& shaper);

/// The poses in the file of that name, times ascending. Throws a failure that names the file and the line.
[[nodiscard]] std::vector<g4lidar::stamped_pose> load_odometry(const std::string& path);

/// The same with the velocities between them.
[[nodiscard]] std::vector<g4lidar::stamped_odometry> load_moving_odometry(const std::string& path);

/// g4lidar::recorded_odometry(). Throws a failure, or interrupted.
[[nodiscard]] std::vector<g4lidar::stamped_odometry> odometry_of_recording(const std::string& path);

}  // namespace g4_tool
