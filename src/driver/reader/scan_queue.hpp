// SPDX-License-Identifier: MIT
// Scans from the thread that reads, for the thread that uses them.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/lidar.hpp"

namespace g4lidar {

/// The last scans that were not taken yet. One thread writes, one takes. *Allocates on
/// open.*
class scan_queue {
 public:
  scan_queue(std::size_t depth, const model& model) : waiting_(depth) {
    for (owned_scan& each : waiting_) each.points().reserve(largest_scan(model));
    taken_.points().reserve(largest_scan(model));
  }

  /// Copies `found`. If there is no room, the oldest scan is dropped and counted. Never waits long.
  void put(const scan& found) {
    {
      const std::lock_guard lock(mutex_);
      if (size_ == waiting_.size()) {
        --size_;
        ++missed_;
      }
      waiting_[put_] = found;
      put_ = (put_ + 1) % waiting_.size();
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
    std::swap(taken_, waiting_[(put_ + waiting_.size() - size_) % waiting_.size()]);
    --size_;
    return taken_.view();
  }

  /// Scans that were dropped.
  [[nodiscard]] std::uint64_t missed() const {
    const std::lock_guard lock(mutex_);
    return missed_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<owned_scan> waiting_;
  owned_scan taken_;     // the last one that was taken: put() does not change it
  std::size_t put_ = 0;  // the index of the next one
  std::size_t size_ = 0;
  std::uint64_t missed_ = 0;
  bool has_ended_ = false;
};

}  // namespace g4lidar
