// SPDX-License-Identifier: MIT
// Where a frame that moves is in a map, scan after scan.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "g4lidar/lidar_service.hpp"
#include "g4lidar/motion.hpp"

namespace g4lidar {

/// Gives the places of one frame, by its odometry or by its velocities. *Single thread.*
class place_tracker {
 public:
  /// `mount`: of the frame on the robot. `begun`: see odometry_feed. Nothing if the path has no pose at that time.
  [[nodiscard]] std::optional<lidar_place> by_path(std::span<const stamped_pose> path,
                                                   const pose_2d& mount, std::int64_t time_ns,
                                                   std::uint64_t begun);
  /// `twist`: of the frame, seen from above; nothing where it is not known. The frame is taken to keep its velocity for
  /// a second; then there is no place, and later ones are in another map.
  [[nodiscard]] std::optional<lidar_place> by_twist(const std::optional<twist_2d>& twist,
                                                    std::int64_t time_ns);

 private:
  std::optional<stamped_pose> last_;  // in the map
  twist_2d velocity_;
  std::int64_t known_ns_ = 0;  // when the velocity was last known
  std::uint64_t begun_ = 0;    // at the last place
  std::uint32_t map_ = 0;
};

}  // namespace g4lidar
