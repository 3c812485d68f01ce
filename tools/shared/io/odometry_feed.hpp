// SPDX-License-Identifier: MIT
// The odometry of a file, a recording or a simulated robot, beside points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "g4lidar/motion.hpp"
#include "g4lidar/odometry_path.hpp"
#include "g4lidar/point.hpp"
#include "source.hpp"

namespace g4_tool {

class odometry_feed {
 public:
  using taker = std::function<void(const g4lidar::stamped_odometry&)>;

  /// That of a file or a recording has precedence. Null: none. From now on points can be earlier ones again.
  void follow(const sim::simulated_source* carried);
  /// The recording of load_recording() is played: its poses are given in each round. Valid as long as points are
  /// given.
  void follow(g4lidar::player& played);
  /// The file of --odometry. Throws a failure.
  void load(const std::string& path);
  /// What a recording holds. Throws a failure.
  void load_recording(const std::string& path);
  /// The times of the file are those of the source plus `shift_ns`.
  void shift(std::int64_t shift_ns);

  /// Whether there is any.
  [[nodiscard]] bool is_known() const noexcept { return robot_ || !all_.empty(); }
  /// How often the odometry has begun: again where a recording does so, or goes on elsewhere.
  [[nodiscard]] std::uint64_t begun() const noexcept { return begun_; }
  /// Gives what was before these points, and the pose after them, in order, each once. Where the times of points go
  /// back, those of the odometry do so, too.
  void follow(std::span<const g4lidar::point> points, const taker& take);

 private:
  void follow_round(std::int64_t time_ns);
  void follow_robot(sim::odometry& robot, std::span<const g4lidar::point> points,
                    const taker& take);

  std::optional<sim::odometry> robot_;
  g4lidar::player* player_ = nullptr;
  std::int64_t begin_ns_ = 0;   // of the robot, or of the round that is played
  std::int64_t last_ns_ = 0;    // of the robot
  std::int64_t points_ns_ = 0;  // of the last points
  std::vector<g4lidar::stamped_odometry> all_;
  std::size_t next_ = 0;
  bool has_begun_ = false;
  std::uint64_t begun_ = 0;
};

}  // namespace g4_tool
