// SPDX-License-Identifier: MIT
// The samples that a simulated lidar sent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "g4lidar/sim/device.hpp"
#include "wire.hpp"

namespace g4lidar::sim {

/// The samples that were sent, for comparisons. When it is full, it drops the oldest entries.
class truth_log {
 public:
  explicit truth_log(std::size_t capacity) : samples_(capacity) {}

  void add(const transmission& sent, bool whole, std::int64_t now_ns) noexcept {
    const std::size_t capacity = samples_.size();
    for (std::uint8_t i = 0; i < sent.count; ++i) {
      if (size_ == capacity) {
        ++missed_;
        if (capacity == 0) continue;
        first_ = (first_ + 1) % capacity;
        --size_;
      }
      samples_[(first_ + size_++) % capacity] = {sent.truths[i], sent.packet, now_ns, i,
                                                 sent.count,     sent.zero,   whole};
    }
  }
  std::size_t take(std::span<sent_sample> out) noexcept {
    std::size_t count = 0;
    for (; count < out.size() && size_ > 0; ++count, --size_) {
      out[count] = samples_[first_];
      first_ = (first_ + 1) % samples_.size();
    }
    return count;
  }
  [[nodiscard]] std::uint64_t missed() const noexcept { return missed_; }

 private:
  std::vector<sent_sample> samples_;  // a ring
  std::size_t first_ = 0;
  std::size_t size_ = 0;
  std::uint64_t missed_ = 0;
};

}  // namespace g4lidar::sim
