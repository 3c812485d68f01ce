// SPDX-License-Identifier: MIT
// The last events, until the caller takes them.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "g4lidar/lidar.hpp"

namespace g4lidar {

/// *Single thread, never allocates.* When it is full, the oldest event is dropped, and `overflow`
/// precedes the oldest remaining one.
class event_queue {
 public:
  void put(const lidar_event& what) noexcept {
    if (size_ == queue_.size()) {
      drop();
      lost_ = true;
    }
    queue_[(begin_ + size_++) % queue_.size()] = what;
  }

  [[nodiscard]] std::optional<lidar_event> take() noexcept {
    if (size_ == 0) return std::nullopt;
    const lidar_event first = queue_[begin_];
    if (lost_) {
      lost_ = false;
      return lidar_event{lidar_event::kind::overflow, first.reason, first.time_ns};
    }
    drop();
    return first;
  }

 private:
  void drop() noexcept {
    begin_ = (begin_ + 1) % queue_.size();
    --size_;
  }

  std::array<lidar_event, 32> queue_{};
  std::size_t begin_ = 0;
  std::size_t size_ = 0;
  bool lost_ = false;
};

}  // namespace g4lidar
