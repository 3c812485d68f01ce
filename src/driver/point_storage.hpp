// SPDX-License-Identifier: MIT
// Memory for points that takes no pages before it is written.
#pragma once

#include <cstddef>
#include <new>
#include <span>
#include <type_traits>

#include "g4lidar/point.hpp"

namespace g4lidar {

/// *Allocates on open.* Room for the largest number of points, of which a program mostly uses few: a vector
/// would write to all of it. Only what was written may be read.
class point_storage {
 public:
  explicit point_storage(std::size_t count)
      : points_(static_cast<point*>(::operator new(count * sizeof(point)))), count_(count) {
    static_assert(std::is_aggregate_v<point> && std::is_trivially_destructible_v<point>);
  }
  point_storage(const point_storage&) = delete;
  point_storage& operator=(const point_storage&) = delete;
  ~point_storage() { ::operator delete(points_); }

  [[nodiscard]] std::span<point> all() noexcept { return {points_, count_}; }

 private:
  point* points_;
  std::size_t count_;
};

}  // namespace g4lidar
