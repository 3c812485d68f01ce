// SPDX-License-Identifier: MIT
// The requests of other threads to the thread of a background_reader, and the waits that they end.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "g4lidar/lidar.hpp"

namespace g4lidar {

/// What other threads want.
struct reader_request {
  bool stops = false;
  bool rests = false;
  std::optional<bool> pauses{};
  std::optional<double> speed{};
  std::optional<std::int64_t> seek_ns{};
  std::vector<std::function<void(lidar*)>> questions{};
};

/// *Any thread* makes requests; one thread takes them.
class reader_requests {
 public:
  template <class Change>
  void add(Change change) {
    const std::lock_guard lock(mutex_);
    change(all_);
    stops_.store(all_.stops, std::memory_order_release);
    is_new_ = true;
    if (waits_ != nullptr) std::exchange(waits_, nullptr)->wake();
    changed_.notify_one();
  }
  [[nodiscard]] bool has_to_stop() const noexcept { return stops_.load(std::memory_order_acquire); }

  // ---- the thread ----
  /// `stops` and `rests` until they change, all else once.
  [[nodiscard]] reader_request take() {
    const std::lock_guard lock(mutex_);
    is_new_ = false;
    return std::exchange(all_, {.stops = all_.stops, .rests = all_.rests});
  }
  /// Until there is a new request, or until then.
  void wait(std::chrono::steady_clock::time_point until) {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, until, [this] { return is_new_; });
  }
  void wait() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return is_new_; });
  }
  /// From now on a request wakes `device`, once. False: there is one already, and nothing is woken.
  [[nodiscard]] bool begin_wait(lidar& device) {
    const std::lock_guard lock(mutex_);
    if (!is_new_) waits_ = &device;
    return !is_new_;
  }
  /// Whether it was woken: then one call of it returns cancelled.
  [[nodiscard]] bool end_wait() {
    const std::lock_guard lock(mutex_);
    return std::exchange(waits_, nullptr) == nullptr;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::atomic<bool> stops_ = false;
  reader_request all_;
  bool is_new_ = false;
  lidar* waits_ = nullptr;
};

}  // namespace g4lidar
