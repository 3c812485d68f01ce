// SPDX-License-Identifier: MIT
// Poses and mountings of C as those of C++.
#pragma once

#include <g4lidar/c/motion.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "g4lidar/motion.hpp"

namespace g4lidar::c {

[[nodiscard]] inline pose_2d pose_of(const g4lidar_pose& given) noexcept {
  return {given.x_m, given.y_m, given.yaw_rad};
}
[[nodiscard]] inline twist_2d twist_of(const g4lidar_twist& given) noexcept {
  return {given.x_m_per_s, given.y_m_per_s, given.yaw_rad_per_s};
}
[[nodiscard]] inline mounting mounting_of(const g4lidar_mounting& given) noexcept {
  return {pose_of(given.pose), given.upside_down};
}
[[nodiscard]] inline g4lidar_odometry odometry_of(const stamped_odometry& given) noexcept {
  return {given.time_ns,
          {given.pose.x_m, given.pose.y_m, given.pose.yaw_rad},
          {given.twist.x_m_per_s, given.twist.y_m_per_s, given.twist.yaw_rad_per_s}};
}
/// Whether the members that this version does not know are 0.
[[nodiscard]] inline bool has_known_members(const g4lidar_mounting& given) noexcept {
  return std::ranges::all_of(given.reserved, [](std::uint8_t each) { return each == 0; });
}
/// Poses in the memory of the caller; nothing if a number is not within its limit, or times do not ascend.
[[nodiscard]] std::optional<std::span<const stamped_pose>> path_of(const g4lidar_stamped_pose* path,
                                                                   std::size_t count) noexcept;
/// Whether all numbers are within their limits.
[[nodiscard]] bool is_usable(const g4lidar_pose& given) noexcept;
/// The same.
[[nodiscard]] bool is_usable(const g4lidar_odometry& given) noexcept;

}  // namespace g4lidar::c
