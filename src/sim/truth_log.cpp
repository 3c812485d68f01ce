// SPDX-License-Identifier: MIT
// A ring that drops the oldest entries.
#include "exact.hpp"

#include "truth_log.hpp"

namespace g4lidar::sim {

void truth_log::add(const transmission& sent, bool whole, std::int64_t now_ns) noexcept {
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

std::size_t truth_log::take(std::span<sent_sample> out) noexcept {
  std::size_t count = 0;
  for (; count < out.size() && size_ > 0; ++count, --size_) {
    out[count] = samples_[first_];
    first_ = (first_ + 1) % samples_.size();
  }
  return count;
}

}  // namespace g4lidar::sim
