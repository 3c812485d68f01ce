// SPDX-License-Identifier: MIT
// Which points are written, in which frame, and with which times: --range, --fov, --ignore, --frame,
// --time.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common_options.hpp"
#include "g4lidar/point.hpp"
#include "values.hpp"

namespace g4_dump {

/// Directions from one on to another, growing, both among them. It goes through the place where the
/// angles begin anew if need be.
class sector {
 public:
  /// Degrees, however many turns away; a whole turn or more from first to last is every direction.
  explicit sector(number_range degrees) noexcept;

  [[nodiscard]] bool is_everything() const noexcept { return everything_; }
  /// Of `degrees` in [0, 360).
  [[nodiscard]] bool has(double degrees) const noexcept {
    const bool from = degrees >= from_;
    const bool to = degrees <= to_;
    return wraps_ ? from || to : from && to;
  }

 private:
  bool everything_;
  double from_;
  double to_;
  bool wraps_;
};

/// What stands in the place of times, in nanoseconds of the monotonic clock.
class time_shift {
 public:
  /// `wall_ahead_ns`: how far the wall clock is ahead, for time_style::absolute.
  time_shift(time_style style, std::int64_t wall_ahead_ns) noexcept
      : style_(style), shift_ns_(style == time_style::absolute ? wall_ahead_ns : 0) {}

  /// Something has come, whether it is written or not.
  void come(std::int64_t time_ns) noexcept {
    if (begun_) return;
    begun_ = true;
    if (style_ == time_style::zero) shift_ns_ = -time_ns;
    before_ns_ = time_ns;
  }
  /// The time of the next record.
  [[nodiscard]] std::int64_t of(std::int64_t time_ns) noexcept {
    if (style_ != time_style::delta) return time_ns + shift_ns_;
    const std::int64_t since = written_ ? time_ns - before_ns_ : 0;
    written_ = true;
    before_ns_ = time_ns;
    return since;
  }
  /// The wall clock was set. Times stay as even as they are unless it was.
  void set_wall_ahead(std::int64_t wall_ahead_ns) noexcept;

 private:
  time_style style_;
  bool begun_ = false;
  bool written_ = false;
  std::int64_t shift_ns_;
  std::int64_t before_ns_ = 0;
};

/// What is done to points before they are written. *Single thread.*
class point_shaper {
 public:
  /// For a grid, points keep the device's angles, and are judged by the direction in which the sensor
  /// looked; a return out of the range is marked as none to be trusted, so that its bin is unknown and
  /// not empty, and those that are asked for are trusted however near.
  enum class purpose : unsigned char { points, grid };

  explicit point_shaper(const common_options& options, purpose what = purpose::points);

  /// Those of `points` that are written, in the order in which they came, with their angles in the
  /// frame as degrees in [0, 360), and their times as they are. Good until the next call.
  [[nodiscard]] std::span<g4lidar::point> shape(std::span<const g4lidar::point> points);

 private:
  template <g4lidar::frame Frame>
  std::size_t shape_into(std::span<const g4lidar::point> points);
  std::size_t shape_for_grid(std::span<const g4lidar::point> points);
  [[nodiscard]] bool has_direction(double degrees) const noexcept;
  [[nodiscard]] bool has_range(float range_mm) const noexcept {
    const auto range = static_cast<double>(range_mm);
    return range >= range_mm_.from && range <= range_mm_.to;
  }

  purpose purpose_;
  g4lidar::frame frame_;
  number_range range_mm_;
  bool all_ranges_;
  bool all_directions_;
  sector fov_;
  std::vector<sector> ignored_;
  std::vector<g4lidar::point> shaped_;
};

}  // namespace g4_dump
