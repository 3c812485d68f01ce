// SPDX-License-Identifier: MIT
// The commands that a simulated G4 has received.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "g4lidar/sim/device.hpp"

namespace g4lidar::sim {

class command_log {
 public:
  explicit command_log(std::size_t capacity) : capacity_(capacity) { entries_.reserve(capacity); }

  void add(const asked& entry) noexcept {
    if (entries_.size() == capacity_) {
      ++missed_;
    } else {
      entries_.push_back(entry);
    }
  }
  void clear() noexcept { entries_.clear(); }
  [[nodiscard]] std::span<const asked> entries() const noexcept { return entries_; }
  [[nodiscard]] std::uint64_t missed() const noexcept { return missed_; }

 private:
  std::size_t capacity_;
  std::vector<asked> entries_;
  std::uint64_t missed_ = 0;
};

}  // namespace g4lidar::sim
