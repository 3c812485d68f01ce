// SPDX-License-Identifier: MIT
// The samples that were sent, for comparisons.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "g4lidar/sim/device.hpp"
#include "wire.hpp"

namespace g4lidar::sim {

class truth_log {
 public:
  explicit truth_log(std::size_t capacity) : samples_(capacity) {}

  void add(const transmission& sent, bool whole, std::int64_t now_ns) noexcept;
  std::size_t take(std::span<sent_sample> out) noexcept;
  [[nodiscard]] std::uint64_t missed() const noexcept { return missed_; }

 private:
  std::vector<sent_sample> samples_;  // a ring
  std::size_t first_ = 0;
  std::size_t size_ = 0;
  std::uint64_t missed_ = 0;
};

}  // namespace g4lidar::sim
