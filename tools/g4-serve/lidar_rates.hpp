// SPDX-License-Identifier: MIT
// The rates and the losses of the recent scans of a lidar.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <mutex>

#include "g4lidar/lidar.hpp"
#include "g4lidar/scan.hpp"
#include "page_protocol.hpp"

namespace g4_tool {

/// The rates of the recent scans. *Any thread.*
class scan_rates {
 public:
  using clock = std::chrono::steady_clock;

  void add(const g4lidar::scan& scan, clock::time_point now);
  /// Sets the rates at `now`; sets nothing if no scan was received recently.
  void put(page_status& into, clock::time_point now) const;

 private:
  mutable std::mutex mutex_;
  std::deque<clock::time_point> times_;
  double sample_rate_hz_ = 0;
  double frequency_hz_ = 0;
};

/// The ratio of lost samples in the last ten seconds. *Single thread.*
class loss_window {
 public:
  /// Call it twice a second with the counts. Returns the ratio.
  double add(const lidar_counts& counts);

 private:
  struct sums {
    std::uint64_t points;
    std::uint64_t lost;
  };
  std::deque<sums> sums_;
};

}  // namespace g4_tool
