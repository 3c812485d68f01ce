// SPDX-License-Identifier: MIT
// Changes of settings that wait for the thread of a lidar, each of which is answered once and in time.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace g4lidar {

/// *Any thread.*
class pending_change {
 public:
  using clock = std::chrono::steady_clock;
  using answer = std::function<void(const std::string&)>;

  pending_change(std::size_t lidar, clock::time_point until, answer done)
      : lidar_(lidar), until_(until), done_(std::move(done)) {}

  [[nodiscard]] std::size_t lidar() const noexcept { return lidar_; }
  [[nodiscard]] clock::time_point until() const noexcept { return until_; }
  [[nodiscard]] bool is_answered() const noexcept { return is_answered_; }
  /// Whether the caller may make it or withdraw it: true for the first call.
  [[nodiscard]] bool claim() noexcept { return !is_claimed_.test_and_set(); }
  /// The first call calls the function.
  void finish(const std::string& why_not) {
    if (!is_answered_.exchange(true)) done_(why_not);
  }

 private:
  const std::size_t lidar_;
  const clock::time_point until_;
  const answer done_;
  std::atomic_flag is_claimed_;
  std::atomic<bool> is_answered_ = false;
};

/// Withdraws those that take too long, or whose lidar is searched.
class pending_changes {
 public:
  /// From now on somebody calls update().
  void begin() {
    const std::lock_guard lock(mutex_);
    is_served_ = true;
  }
  /// Whether it is answered by update() or end().
  [[nodiscard]] bool add(std::shared_ptr<pending_change> made) {
    const std::lock_guard lock(mutex_);
    std::erase_if(all_, [](const auto& each) { return each->is_answered(); });
    if (is_served_) all_.push_back(std::move(made));
    return is_served_;
  }
  /// `is_searched(lidar)`. Whether some are left.
  template <class IsSearched>
  bool update(IsSearched is_searched) {
    std::vector<std::shared_ptr<pending_change>> now;
    {
      const std::lock_guard lock(mutex_);
      std::erase_if(all_, [](const auto& each) { return each->is_answered(); });
      now = all_;
    }
    for (const auto& each : now) {
      if (pending_change::clock::now() >= each->until()) {
        each->finish(each->claim() ? "the lidar did not answer in time"
                                   : "the lidar did not answer in time; it may be set later");
      } else if (is_searched(each->lidar()) && each->claim()) {
        each->finish("the lidar is not connected");
      }
    }
    return !now.empty();
  }
  /// Withdraws all that nobody makes now, and takes no more.
  void end() {
    {
      const std::lock_guard lock(mutex_);
      is_served_ = false;
    }
    update([](std::size_t) { return true; });
  }

 private:
  std::mutex mutex_;
  bool is_served_ = false;
  std::vector<std::shared_ptr<pending_change>> all_;
};

}  // namespace g4lidar
