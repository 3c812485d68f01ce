// SPDX-License-Identifier: MIT
// The search for the twist that moves two revolutions onto the same surfaces.
#pragma once

#include <array>
#include <cstddef>

#include "g4lidar/motion.hpp"
#include "g4lidar/motion/twist_estimator.hpp"
#include "motion/line_map.hpp"
#include "motion/scan_points.hpp"
#include "motion/symmetric_3.hpp"

namespace g4lidar {

/// Iterated point-to-line matching. Each iteration places both revolutions with the twist it has, and corrects it.
class twist_search {
 public:
  /// The twist, searched from `last` and from the coarse yaw rate. The number of iterations is bounded.
  [[nodiscard]] twist_estimate find(const scan_points& before, const scan_points& after,
                                    const twist_2d& last) noexcept;

 private:
  /// A point and the line that it is matched with.
  struct match {
    vector_3 slope;     // of the distance, by x, y (per m/s) and yaw (per rad/s)
    vector_3 sideways;  // the same of the position along the line
    double distance;    // from the line
    double normal_variance;
    double variance;  // of the points of the line
  };
  /// The information that the matches have about the twist, in directions that are independent of each other.
  struct information {
    eigen_3 of;               // yaw in units of 1 / lever
    vector_3 correction;      // along of.vector
    vector_3 variance;        // the same
    std::array<bool, 3> has;  // the same
    double lever;             // the distance at which turning moves points as far as driving
    double widening;          // of the variances of the estimate, if the twist was not constant
    double noise;             // standard deviation of the distances
  };

  void match_points(const scan_points& before, const scan_points& after, const twist_2d& twist,
                    std::size_t step) noexcept;
  [[nodiscard]] double misfit() const noexcept;
  [[nodiscard]] double noise() noexcept;
  [[nodiscard]] information inform(double width) noexcept;
  [[nodiscard]] static double correct(twist_2d& twist, const information& info) noexcept;
  [[nodiscard]] bool fits(const information& info) const noexcept;
  [[nodiscard]] static twist_estimate describe(const twist_2d& twist,
                                               const information& info) noexcept;

  positions before_;
  positions after_;
  line_map lines_;
  std::array<match, most_returns> matches_;
  std::array<double, most_returns> distances_;
  std::size_t matched_ = 0;
  std::size_t tried_ = 0;
};

/// The yaw rate, within 0.5 degrees per revolution, at which the ranges of both by direction are most alike.
[[nodiscard]] double coarse_yaw_rate(const scan_points& before, const scan_points& after) noexcept;

/// An estimate without any knowledge.
[[nodiscard]] twist_estimate unknown_twist(twist_status why, const twist_2d& last) noexcept;

}  // namespace g4lidar
