// SPDX-License-Identifier: MIT
// Scans and poses as the text files that SLAM programs read: CARMEN logs and TUM trajectories.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "g4lidar/motion.hpp"
#include "io/text_sink.hpp"
#include "point_writer.hpp"

namespace g4_tool {

/// A scan for write_carmen_scan().
struct carmen_scan {
  /// The bins that fill_grid() fills in the robot's frame, in metres: at least two. Bins without a range (infinity,
  /// NaN, 0) are written as `max_range_m`, which programs take as "no return".
  std::span<const float> ranges_m;
  float max_range_m = 30.0F;  ///< Above all ranges.
  pose_2d robot{};            ///< The robot's pose by its odometry when the scan was taken.
  pose_2d mount{};            ///< The place of the lidar's own frame in the frame of the robot.
  std::int64_t stamp_ns = 0;  ///< When the scan was taken, in any clock that does not go back.
};

/// Writes one line `ROBOTLASER1` of a CARMEN log. Programs place the ranges evenly and symmetrically around the
/// laser's x axis, so the written laser pose is turned by half a bin. Tested with MRPT's carmen2rawlog.
void write_carmen_scan(const carmen_scan& scan, text_sink& out);

/// The writer of revolutions as lines of a CARMEN log with `bins` ranges, at least two, with scan_record::robot and
/// scan_record::time_ns. *Allocates on construction.*
[[nodiscard]] std::unique_ptr<point_writer> make_carmen_writer(std::size_t bins,
                                                               const mounting& mount = {});

/// The writer of scan_record::robot and scan_record::time_ns of each revolution as lines of a TUM trajectory.
[[nodiscard]] std::unique_ptr<point_writer> make_tum_writer();

/// Writes one line of a TUM trajectory: the time in seconds, the position in metres (z is 0), and the rotation as a
/// quaternion x y z w.
void write_tum_pose(const stamped_pose& pose, text_sink& out);

}  // namespace g4_tool
