// SPDX-License-Identifier: MIT
// What the threads of lidars give to that of the screen.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "cli/logger.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/lidar_service.hpp"
#include "wake_descriptor.hpp"

namespace g4_tool {

class newest_scan final : public service_sink {
 public:
  /// `keeps`: the first one at a steady speed stays.
  explicit newest_scan(bool keeps) : keeps_(keeps) {}

  [[nodiscard]] service_demand wanted() const override { return {.kept = true}; }
  void on_open(std::size_t /*lidar*/, g4lidar::lidar& device) override {
    logger::verbose("opened " + std::string(device.name()) + '\n');
  }
  void on_scan(const service_scan& made) override {
    {
      const scan& found = made.kept;
      const std::lock_guard lock(mutex_);
      if ((!found.is_whole() && has_whole_) || (keeps_ && is_steady_)) return;
      has_whole_ = found.is_whole();
      // While the head speeds up, each revolution is faster than the one before.
      const float frequency_hz = found.measured_frequency_hz();
      is_steady_ = has_whole_ && std::abs(frequency_hz - frequency_hz_) < 0.02F * frequency_hz;
      frequency_hz_ = frequency_hz;
      scan_ = found;
      place_ = made.place;
      is_new_ = true;
    }
    wake_.wake();
  }
  void on_event(std::size_t /*lidar*/, const lidar_event& event,
                std::int64_t /*stamp_ns*/) override {
    const std::lock_guard lock(mutex_);
    event_ = name_of(event.what);
  }
  void on_state(std::size_t /*lidar*/, reader_state /*state*/,
                const std::optional<error>& /*why*/) override {
    wake_.wake();
  }

  /// The newest revolution with its place, if it was not taken yet.
  [[nodiscard]] bool take(owned_scan& into, std::optional<lidar_place>& place, std::string& event) {
    const std::lock_guard lock(mutex_);
    event = event_;
    if (!std::exchange(is_new_, false)) return false;
    std::swap(into, scan_);
    place = place_;
    return true;
  }
  [[nodiscard]] bool is_steady() const {
    const std::lock_guard lock(mutex_);
    return is_steady_;
  }
  void wait(std::chrono::steady_clock::time_point until, int other) const {
    wake_.wait(other, until);
  }

 private:
  wake_descriptor wake_;
  mutable std::mutex mutex_;
  owned_scan scan_;
  std::optional<lidar_place> place_;
  std::string event_;
  bool is_new_ = false;
  bool keeps_;
  bool has_whole_ = false;
  bool is_steady_ = false;
  float frequency_hz_ = 0;
};

}  // namespace g4_tool
