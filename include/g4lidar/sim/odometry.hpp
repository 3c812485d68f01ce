// SPDX-License-Identifier: MIT
// The odometry of a simulated robot: its way as its wheels count it.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/sim/random.hpp"
#include "g4lidar/sim/world.hpp"

namespace g4lidar::sim {

/// By default without errors.
struct odometry_options {
  std::uint64_t seed = 1;  ///< Of all random values below.
  double rate_hz = 50.0;   ///< Poses per second, 0.1 to 1000.
  /// The standard deviation of the length of a way of 1 m, as a part of it, 0 to 1. It grows with
  /// the square root of the way, at any rate.
  double way_noise = 0.0;
  /// The same for the angle of a turn, for one of 90 degrees.
  double turn_noise = 0.0;
  /// The part by which the wheels count each way too long, -0.5 to 0.5, and each turn too far.
  double way_slip = 0.0;
  double turn_slip = 0.0;
};

/// What is wrong with `options`, a sentence for people; empty if nothing is. *Pure.*
[[nodiscard]] G4LIDAR_API std::string_view problem_with(const odometry_options& options) noexcept;

/// The pose that odometry reports, in the frame in which its true pose at time 0 is zero, and its mean
/// velocity since the sample before, in its own frame; zero at time 0.
struct odometry_sample {
  std::int64_t time_ns;  ///< As those of the lidar's samples.
  double x_m;
  double y_m;
  double yaw_rad;  ///< Counter-clockwise, [-pi, pi].
  double forward_m_per_s;
  double left_m_per_s;
  double yaw_rad_per_s;

  friend constexpr bool operator==(const odometry_sample&,
                                   const odometry_sample&) noexcept = default;
};

/// Counts the way of the robot of a world, without end. The same options and path give the same
/// numbers on every processor. *Single thread. Allocates on construction only.* A copy is
/// independent.
class G4LIDAR_API odometry {
 public:
  /// `problem_with(options)` must be empty; otherwise an assertion fails.
  odometry(const world& scene, const odometry_options& options);

  /// The next sample; the first is that of time 0.
  [[nodiscard]] odometry_sample next() noexcept;
  /// The time of the next sample.
  [[nodiscard]] std::int64_t next_ns() const noexcept;

 private:
  odometry_options options_;
  std::vector<path_point> path_;
  random_stream way_noise_;
  random_stream turn_noise_;
  std::uint64_t index_ = 0;
  pose truth_;     // at the sample before
  pose believed_;  // its heading is not wrapped
};

}  // namespace g4lidar::sim
