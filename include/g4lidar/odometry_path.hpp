// SPDX-License-Identifier: MIT
// The newest poses of a robot, by its odometry.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/motion.hpp"

namespace g4lidar {

/// The poses of the last 5 s, for scan_shaper::shape(). *Single thread.* Throws only what std::vector throws.
class G4LIDAR_API odometry_path {
 public:
  /// A pose that is not after the last one begins a new path.
  void add(const stamped_odometry& now);
  /// The poses, times ascending. If the last one is at most 0.2 s before `time_ns`, one more at that time, as if the
  /// robot had kept its velocity. Valid until the next call.
  [[nodiscard]] std::span<const stamped_pose> until(std::int64_t time_ns);
  /// The last one that was added.
  [[nodiscard]] const std::optional<stamped_odometry>& newest() const noexcept { return newest_; }

 private:
  std::optional<stamped_odometry> newest_;
  std::vector<stamped_pose> poses_;
  bool is_last_guessed_ = false;
};

}  // namespace g4lidar
