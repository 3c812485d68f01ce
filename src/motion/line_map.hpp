// SPDX-License-Identifier: MIT
// The surfaces that a revolution shows, as short lines, and the search for the one at a position.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "motion/scan_points.hpp"

namespace g4lidar {

/// The line through the points around one point.
struct fitted_line {
  double x;  ///< The mean of the points.
  double y;
  double normal_x;  ///< Of length 1.
  double normal_y;
  double normal_variance;  ///< Of its direction, in square radians.
  double variance;         ///< Of the distances of these points from it, in square metres.
};

/// The lines of a revolution and an index of them by direction from the origin.
class line_map {
 public:
  /// Replaces the contents: the lines through the first `count` of `points`, which are in the order of measurement.
  /// Where the range jumps, at corners, and on what is too small there is no line.
  void build(const positions& points, std::size_t count) noexcept;

  static constexpr std::size_t none = most_returns;
  /// The index of the point nearest to the position that has a line and is within `reach_m`, in about the same
  /// direction; `none` if there is none. Constant time per line in this direction.
  [[nodiscard]] std::size_t nearest(double x, double y, double reach_m) const noexcept;
  /// Whether there is any line in about the direction of the position.
  [[nodiscard]] bool has_direction(double x, double y) const noexcept;

  /// The line of point `i`, which has one.
  [[nodiscard]] const fitted_line& operator[](std::size_t i) const noexcept { return lines_[i]; }

 private:
  struct sums {
    double x, y, xx, xy, yy;
  };
  /// From direction `from`, up to `to` without it: one or two ranges without wrap.
  struct sector {
    std::array<std::size_t, 2> from, to;
  };
  struct entry {
    double x, y;
    std::uint32_t index;
  };
  static constexpr std::size_t directions = 720;

  [[nodiscard]] static sector sector_at(double x, double y) noexcept;
  void add_up(const positions& points, std::size_t count) noexcept;
  [[nodiscard]] bool fit(std::size_t from, std::size_t to, double range,
                         fitted_line& out) const noexcept;
  void sort(const positions& points, std::size_t count) noexcept;

  std::array<sums, most_returns + 1> sums_;        // of all points before an index
  std::array<std::uint32_t, most_returns> piece_;  // increases where the range jumps
  std::array<fitted_line, most_returns> lines_;
  std::array<bool, most_returns> has_line_;
  std::array<std::uint32_t, most_returns> direction_;
  std::array<std::uint32_t, directions + 1> first_;  // in entries_, for each direction
  std::array<entry, most_returns> entries_;
  std::size_t size_ = 0;
};

}  // namespace g4lidar
