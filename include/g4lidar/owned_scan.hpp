// SPDX-License-Identifier: MIT
// A scan that owns its points.
#pragma once

#include <utility>
#include <vector>

#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"

namespace g4lidar {

/// A copy of a scan that owns its points. *Allocates* when it is constructed and copied, and throws
/// only what std::vector throws.
class owned_scan {
 public:
  /// Without points.
  owned_scan() = default;
  /// A copy of `source` and its points.
  explicit owned_scan(const scan& source) { *this = source; }
  /// The same; memory that is large enough is reused.
  owned_scan& operator=(const scan& source) {
    points_.assign(source.begin(), source.end());
    about_ = source;
    about_.points = {};
    return *this;
  }

  /// As a scan; valid until this object changes or is destroyed.
  [[nodiscard]] scan view() const& noexcept {
    scan made = about_;
    made.points = points_;
    return made;
  }
  scan view() const&& = delete;
  /// The same.
  [[nodiscard]] operator scan() const& noexcept { return view(); }
  operator scan() const&& = delete;

  /// The points, in the order in which they were measured. They may be changed.
  [[nodiscard]] std::vector<point>& points() & noexcept { return points_; }
  /// The same.
  [[nodiscard]] const std::vector<point>& points() const& noexcept { return points_; }
  /// The points of a temporary object.
  [[nodiscard]] std::vector<point> points() && noexcept { return std::move(points_); }

 private:
  std::vector<point> points_;
  scan about_;
};

}  // namespace g4lidar
