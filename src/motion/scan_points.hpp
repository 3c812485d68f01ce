// SPDX-License-Identifier: MIT
// The returns of one revolution as positions and times, in fixed storage.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "g4lidar/motion.hpp"
#include "g4lidar/motion/twist_estimator.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar {

inline constexpr std::size_t most_returns = 2048;

/// Positions of points, index by index.
struct positions {
  std::array<double, most_returns> x;
  std::array<double, most_returns> y;
};

/// The returns of a scan in the order in which they were measured, without isolated ones.
class scan_points {
 public:
  /// Replaces the contents: the returns from `shortest_mm` on, of a lidar with this turn.
  void load(std::span<const point> points, std::uint16_t turn_deg,
            std::uint16_t shortest_mm) noexcept;
  void clear() noexcept { why_unusable_ = twist_status::first_scan; }

  /// Why it cannot be compared with other scans.
  [[nodiscard]] std::optional<twist_status> why_unusable() const noexcept { return why_unusable_; }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::int64_t first_ns() const noexcept { return first_ns_; }
  [[nodiscard]] std::int64_t last_ns() const noexcept { return last_ns_; }
  /// When point `i` was measured, in seconds since first_ns().
  [[nodiscard]] double seconds(std::size_t i) const noexcept { return seconds_[i]; }

  /// Where the points are in the frame in which the lidar was at `time_ns`, if it moves with `twist`.
  void place(const twist_2d& twist, std::int64_t time_ns, positions& out) const noexcept;

  /// The range in millimetres in each degree of the bearing, 0 where there is no return.
  static constexpr std::size_t directions = 360;
  [[nodiscard]] const std::array<std::int32_t, directions>& profile() const noexcept {
    return profile_;
  }

 private:
  [[nodiscard]] std::optional<twist_status> read(std::span<const point> points,
                                                 std::uint16_t turn_deg,
                                                 std::uint16_t shortest_mm) noexcept;
  void drop_isolated() noexcept;

  positions own_;  // in the lidar's own frame
  std::array<double, most_returns> seconds_;
  std::array<std::int32_t, directions> profile_;
  std::size_t size_ = 0;
  std::int64_t first_ns_ = 0;
  std::int64_t last_ns_ = 0;
  std::optional<twist_status> why_unusable_ = twist_status::first_scan;
};

}  // namespace g4lidar
