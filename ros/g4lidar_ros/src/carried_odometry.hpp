// SPDX-License-Identifier: MIT
// The odometry that a source carries: that of a recording, or of a simulated robot.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/sim/simulated_source.hpp"

namespace g4lidar_ros {

/// *Single thread*: that of the reader, except construction.
class carried_odometry {
 public:
  using taker = std::function<void(const g4lidar::stamped_odometry&)>;

  /// Reads that of a recording. What cannot be read is reported when the source is opened as a lidar.
  explicit carried_odometry(const std::string& source);

  /// Whether the source carries any.
  [[nodiscard]] bool is_known() const noexcept { return has_robot_ || !recorded_.empty(); }
  /// The source is open. `simulation`: null unless it is simulated.
  void follow(g4lidar::lidar& device, const g4lidar::sim::simulated_source* simulation);
  /// Gives what was before these points, and the pose after them, in order, each once. Where the times of points go
  /// back, those of the odometry do so, too.
  void follow(std::span<const g4lidar::point> points, const taker& take);

 private:
  void follow_recorded(std::span<const g4lidar::point> points, const taker& take);
  void follow_robot(std::span<const g4lidar::point> points, const taker& take);

  bool has_robot_;
  std::optional<g4lidar::sim::odometry> robot_;
  std::vector<g4lidar::stamped_odometry> recorded_;
  g4lidar::player* player_ = nullptr;  // of the recording that is open
  std::int64_t begin_ns_ = 0;          // of the robot, or of the round of the recording
  std::int64_t points_ns_ = 0;         // of the last points
  std::int64_t last_ns_ = 0;           // of the robot
  std::size_t next_ = 0;               // of recorded_
  bool has_begun_ = false;
};

}  // namespace g4lidar_ros
