// SPDX-License-Identifier: MIT
// Scans from the thread that reads, for the thread that uses them.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/scan.hpp"

namespace g4lidar {

/// The last scans that were not taken yet. One thread writes, one takes. *Allocates on
/// open.*
class scan_queue {
 public:
  scan_queue(std::size_t depth, const model& model) : slots_(depth + 1) {
    for (slot& each : slots_) each.points.reserve(largest_scan(model));
  }

  /// Copies `found`. If there is no room, the oldest scan is dropped and counted. Never waits long.
  void put(const scan& found) {
    {
      const std::lock_guard lock(mutex_);
      if (size_ + 1 == slots_.size()) {
        --size_;
        ++missed_;
      }
      slot& to = slots_[put_];
      to.points.assign(found.points.begin(), found.points.end());
      to.about = found;
      to.about.points = to.points;
      put_ = (put_ + 1) % slots_.size();
      ++size_;
      has_ended_ = false;
    }
    changed_.notify_one();
  }

  /// No more scans follow, until put() or go_on() is called.
  void end() {
    {
      const std::lock_guard lock(mutex_);
      has_ended_ = true;
    }
    changed_.notify_all();
  }

  /// Scans may follow.
  void go_on() {
    const std::lock_guard lock(mutex_);
    has_ended_ = false;
  }

  /// The oldest scan, valid until the next call; nothing if none arrived by the deadline, or no
  /// more follow.
  [[nodiscard]] std::optional<scan> take(std::chrono::steady_clock::time_point deadline) {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, deadline, [this] { return size_ > 0 || has_ended_; });
    if (size_ == 0) return std::nullopt;
    const std::size_t at = (put_ + slots_.size() - size_) % slots_.size();
    --size_;
    return slots_[at].about;
  }

  /// Scans that were dropped.
  [[nodiscard]] std::uint64_t missed() const {
    const std::lock_guard lock(mutex_);
    return missed_;
  }

 private:
  struct slot {
    std::vector<point> points;
    scan about;
  };

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<slot> slots_;  // the waiting ones, and the one that was taken last
  std::size_t put_ = 0;      // the index of the next one
  std::size_t size_ = 0;
  std::uint64_t missed_ = 0;
  bool has_ended_ = false;
};

}  // namespace g4lidar
