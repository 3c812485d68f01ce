// SPDX-License-Identifier: MIT
// The ranges of the LaserScan messages of a recording.
#pragma once

#include <cstddef>
#include <new>
#include <span>
#include <vector>

#include "g4lidar/grid.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/recording/writer.hpp"
#include "g4lidar/scan.hpp"
#include "g4lidar/scan_shaper.hpp"

namespace g4lidar {

/// *Single thread.*
class scan_ranges {
 public:
  explicit scan_ranges(const recording_options& options)
      : ranges_(options.scan_bins),
        intensities_(options.scan_bins),
        shaper_({.marks = {.near = options.near}}) {}

  /// Fills them, and returns message_header::first_bin.
  std::size_t fill(const scan& revolution, const recording_options& options) noexcept {
    std::span<const point> points = revolution.points;
    has_intensity_ = has_intensity(*revolution.model);
    const std::span<float> intensities =
        std::span(intensities_).first(has_intensity_ ? ranges_.size() : 0);
    try {
      shaper_.shape(revolution);
      points = shaper_.for_grid();
    } catch (const std::bad_alloc&) {  // without the flags
    }
    if (options.order == scan_order::time) {
      return fill_time_grid(points, revolution.duration_ns, ranges_, options.grid, intensities);
    }
    grid_options how = options.grid;
    how.to = frame::robot;
    fill_grid(points, ranges_, how, intensities);
    return 0;
  }
  [[nodiscard]] std::span<const float> ranges_m() const noexcept { return ranges_; }
  /// Of the same revolution; empty if its model has none.
  [[nodiscard]] std::span<const float> intensities() const noexcept {
    return std::span(intensities_).first(has_intensity_ ? ranges_.size() : 0);
  }

 private:
  std::vector<float> ranges_;
  std::vector<float> intensities_;
  bool has_intensity_ = false;
  scan_shaper shaper_;
};

}  // namespace g4lidar
