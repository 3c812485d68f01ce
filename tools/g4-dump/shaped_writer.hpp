// SPDX-License-Identifier: MIT
// A writer that shapes what comes, hands it to another one, and knows when that has been enough.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "common_options.hpp"
#include "point_shaper.hpp"
#include "point_writer.hpp"

namespace g4_dump {

/// What a shaped_writer is to know beside the options.
struct shape_plan {
  point_shaper::purpose purpose = point_shaper::purpose::points;
  time_style time = time_style::monotonic;
  std::int64_t wall_ahead_ns = 0;   ///< For time_style::absolute.
  bool follows_wall_clock = false;  ///< Whether it is looked at again while this runs.
  bool partial_scans = false;       ///< Whether pieces of revolutions are written.
  bool counts_duration = false;     ///< -d by the times of the points, and not by the clock here.
};

/// Stands before the writer of a format. *Single thread.*
class shaped_writer final : public point_writer {
 public:
  shaped_writer(std::unique_ptr<point_writer> inner, const common_options& options,
                const shape_plan& plan);

  [[nodiscard]] bool takes_scans() const noexcept override { return inner_->takes_scans(); }
  void begin(output& out) override;
  /// Any number of points.
  void write_points(std::span<const g4lidar::point> points, output& out) override;
  void write_scan(const shown_scan& shown, output& out) override;

  /// Whether -n or -d is reached.
  [[nodiscard]] bool is_done() const noexcept { return done_; }
  [[nodiscard]] std::uint64_t records() const noexcept { return records_; }
  /// Revolutions of which only a piece was seen, and that were left out for it.
  [[nodiscard]] std::uint64_t pieces_left_out() const noexcept { return pieces_; }

 private:
  /// Those of `points` that belong to the duration.
  [[nodiscard]] std::span<const g4lidar::point> in_time(std::span<const g4lidar::point> points);
  void look_at_clock();

  std::unique_ptr<point_writer> inner_;
  shape_plan plan_;
  std::uint64_t count_;
  std::int64_t duration_ns_;
  point_shaper shaper_;
  time_shift times_;
  time_shift scan_times_;
  std::optional<std::int64_t> first_ns_;
  bool begun_ = false;
  bool done_ = false;
  std::uint64_t records_ = 0;
  std::uint64_t pieces_ = 0;
};

/// How far the system's wall clock is ahead of the monotonic one.
[[nodiscard]] std::int64_t wall_ahead_ns() noexcept;

}  // namespace g4_dump
