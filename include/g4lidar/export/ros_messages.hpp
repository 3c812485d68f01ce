// SPDX-License-Identifier: MIT
// ROS 2 messages of scans and points, in CDR: for recordings, and for nodes that publish serialized
// messages. Does not need ROS.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar {

/// The header of a message, and the duration of the revolution.
struct message_header {
  std::int64_t stamp_ns = 0;     ///< Of the first point, nanoseconds since 1970.
  std::string_view frame_id{};   ///< The coordinate frame, such as "laser".
  std::int64_t duration_ns = 0;  ///< From the first point to the first one of the next revolution.
};

/// The name and the definition of a message, as recordings contain them. Valid forever.
struct message_schema {
  std::string_view name;
  std::string_view text;
};
[[nodiscard]] G4LIDAR_API message_schema laser_scan_schema() noexcept;    ///< LaserScan.
[[nodiscard]] G4LIDAR_API message_schema point_cloud2_schema() noexcept;  ///< PointCloud2.

/// Appends a sensor_msgs/msg/LaserScan to `out`: `ranges_m` are the bins that fill_grid() fills in
/// the robot's frame, at least one. angle_min is -pi, angle_increment 2 pi / bins, range_min 0.1 m
/// (ranges below are not reliable), range_max 16.38375 m (the maximum of the protocol);
/// time_increment is 0, because the bins are not in the order of time: the device turns against the
/// direction in which the angles grow. Without intensities. Allocates beyond the capacity of `out`.
G4LIDAR_API void put_laser_scan(std::span<const float> ranges_m, const message_header& header,
                                std::vector<std::uint8_t>& out);

/// Appends a sensor_msgs/msg/PointCloud2 of the returns among `points`, in their order, in the robot's
/// frame: float32 x, y, z in metres (z is 0) and uint32 t, nanoseconds since the first of `points`.
/// One row, is_dense. Allocates beyond the capacity of `out`.
G4LIDAR_API void put_point_cloud2(std::span<const point> points, const message_header& header,
                                  std::vector<std::uint8_t>& out);

}  // namespace g4lidar
