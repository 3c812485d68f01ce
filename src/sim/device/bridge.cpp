// SPDX-License-Identifier: MIT
// A batch begins with its first byte; its duration is drawn at that time.
#include "sim/exact.hpp"

#include "bridge.hpp"

#include <algorithm>

#include "sim/purpose.hpp"

namespace g4lidar::sim {

bridge::bridge(const device_options& options) noexcept
    : min_ns_(options.batch_min_ns),
      range_ns_(options.batch_max_ns - options.batch_min_ns),
      random_(stream_for(options.scanner.seed, purpose::batches)) {}

std::int64_t bridge::wait_ns(fault_injector& faults) noexcept {
  // Always drawn, so that a fault does not change later random numbers.
  const std::uint64_t drawn = random_.next() >> 32;
  if (const fault* batch = faults.find(fault_kind::batch)) {
    const auto most = static_cast<std::uint64_t>(batch->amount);
    return static_cast<std::int64_t>(faults.draw(fault_kind::batch, most + 1));
  }
  return min_ns_ + static_cast<std::int64_t>(drawn * static_cast<std::uint64_t>(range_ns_) >> 32);
}

bool bridge::take(std::uint8_t byte, fault_injector& faults, std::int64_t now_ns) noexcept {
  if (next_ns_ == forever_ns) next_ns_ = now_ns + wait_ns(faults);
  return waiting_.push(byte);
}

void bridge::flush(const fault_injector& faults) noexcept {
  if (faults.find(fault_kind::stall) != nullptr) {
    next_ns_ = faults.end_of(fault_kind::stall);
    if (next_ns_ != forever_ns) return;
    waiting_.clear();  // for ever
  }
  for (; !waiting_.empty(); waiting_.pop()) {
    ++delivered_;
    if (!host_.push(waiting_.front())) ++overflowed_;
  }
  next_ns_ = forever_ns;
}

void bridge::reset() noexcept {
  waiting_.clear();
  host_.clear();
  next_ns_ = forever_ns;
}

std::size_t bridge::read(std::span<std::uint8_t> out) noexcept {
  const std::size_t count = std::min(out.size(), host_.size());
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = host_.front();
    host_.pop();
  }
  return count;
}

}  // namespace g4lidar::sim
