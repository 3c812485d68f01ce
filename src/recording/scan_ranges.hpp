// SPDX-License-Identifier: MIT
// The ranges of the LaserScan messages of a recording.
#pragma once

#include <algorithm>
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
      : shaper_({.marks = {.near = options.near}}) {
    const std::size_t most = options.scan_bins.value_or(
        default_bins(*std::ranges::max_element(models, {}, default_bins)));
    ranges_.reserve(most);
    intensities_.reserve(most);
  }

  /// Fills them, and returns message_header::first_bin.
  std::size_t fill(scan revolution, const recording_options& options) noexcept {
    const std::size_t bins = options.scan_bins.value_or(default_bins(*revolution.model));
    ranges_.resize(std::clamp<std::size_t>(bins, 1, ranges_.capacity()));
    intensities_.resize(has_intensity(*revolution.model) ? ranges_.size() : 0);
    const std::span<const point> whole = revolution.points;
    try {
      shaper_.shape(revolution);
      revolution = shaper_.for_grid();
    } catch (const std::bad_alloc&) {
      revolution.points = whole;  // without the flags
    }
    if (options.order == scan_order::time) {
      return fill_time_grid(revolution, ranges_, options.grid, intensities_);
    }
    grid_options how = options.grid;
    how.to = frame::robot;
    fill_grid(revolution, ranges_, how, intensities_);
    return 0;
  }
  [[nodiscard]] std::span<const float> ranges_m() const noexcept { return ranges_; }
  /// Of the same revolution; empty if its model has none.
  [[nodiscard]] std::span<const float> intensities() const noexcept { return intensities_; }

 private:
  std::vector<float> ranges_;
  std::vector<float> intensities_;
  scan_shaper shaper_;
};

}  // namespace g4lidar
