// SPDX-License-Identifier: MIT
// The odometry of a file, a recording or a simulated robot, beside the points of the lidar that it carries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/recording/player.hpp"
#include "g4lidar/transport/source.hpp"

namespace g4lidar {

/// The odometry of a recording, times ascending, each once; what is damaged is left out. `is_cancelled` is that of
/// reading_options. Fails like recording_reader::open() and recording_reader::for_each().
[[nodiscard]] G4LIDAR_API result<std::vector<stamped_odometry>> recorded_odometry(
    const std::string& path, const std::function<bool()>& is_cancelled = {});

/// Gives the odometry in time with the points of a lidar. That of a file or a recording has precedence over that of a
/// simulated robot. *Single thread.* Throws only what std::vector and the callers' functions throw.
class G4LIDAR_API odometry_feed {
 public:
  /// Takes each pose when its time has come.
  using taker = std::function<void(const stamped_odometry&)>;

  /// All that there is, times ascending, by the clock of the points.
  void set(std::vector<stamped_odometry> all) { all_ = std::move(all); }
  /// The odometry of recorded_odometry(). Fails like it, and then there is none.
  [[nodiscard]] result<void> load_recording(const std::string& path,
                                            const std::function<bool()>& is_cancelled = {});
  /// From now on, the times of set() are `shift_ns` later.
  void shift(std::int64_t shift_ns);

  /// A simulated lidar is open: see simulation_of(); null: another one. From now on points can be earlier ones again.
  void follow(const sim::simulated_source* carried);
  /// The recording of load_recording() is open, and played: its poses are given in each round. Valid as long as points
  /// are given.
  void follow(player& played);

  /// Whether there is any.
  [[nodiscard]] bool is_known() const noexcept { return robot_ || !all_.empty(); }
  /// How often the odometry has begun: again where a recording does so, or goes on elsewhere.
  [[nodiscard]] std::uint64_t begun() const noexcept { return begun_; }
  /// Gives what was before these points, and the pose after them, in order, each once. Where the times of points go
  /// back, those of the odometry do so, too.
  void follow(std::span<const point> points, const taker& take);

 private:
  void follow_round(std::int64_t time_ns);
  void follow_robot(std::span<const point> points, const taker& take);

  std::function<stamped_odometry()> robot_;
  stamped_odometry coming_{};  // the next one of the robot
  player* player_ = nullptr;
  std::int64_t begin_ns_ = 0;   // of the round that is played
  std::int64_t last_ns_ = 0;    // of the robot
  std::int64_t points_ns_ = 0;  // of the last points
  std::vector<stamped_odometry> all_;
  std::size_t next_ = 0;
  bool has_begun_ = false;
  std::uint64_t begun_ = 0;
};

}  // namespace g4lidar
