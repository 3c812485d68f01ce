// SPDX-License-Identifier: MIT
// Bytes from a receive interrupt to the main loop, without a lock and without switching interrupts off.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

/// A first-in, first-out ring of `Size` bytes, a power of two. One producer: the interrupt. One consumer:
/// the main loop. A byte for which there is no room is dropped and counted. A G4 sends up to 23 bytes a
/// millisecond: `Size` over 23 is for how many milliseconds the main loop may do something else.
template <std::size_t Size>
class byte_ring {
  static_assert(std::has_single_bit(Size));
  static_assert(std::atomic<std::uint32_t>::is_always_lock_free);

 public:
  /// The producer only.
  void push(std::uint8_t byte) noexcept {
    const std::uint32_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == Size) {
      overruns_.store(overruns_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
      return;
    }
    bytes_[end % Size] = byte;
    end_.store(end + 1, std::memory_order_release);
  }

  /// The consumer only: moves what is there, as much as fits, to the front of `out`; gives that front.
  [[nodiscard]] std::span<const std::uint8_t> take(std::span<std::uint8_t> out) noexcept {
    const std::uint32_t begin = begin_.load(std::memory_order_relaxed);
    const std::size_t there = end_.load(std::memory_order_acquire) - begin;
    const std::size_t count = std::min(there, out.size());
    for (std::size_t i = 0; i < count; ++i) out[i] = bytes_[(begin + i) % Size];
    begin_.store(begin + static_cast<std::uint32_t>(count), std::memory_order_release);
    return out.first(count);
  }

  /// How many bytes found no room, over all.
  [[nodiscard]] std::uint32_t overruns() const noexcept {
    return overruns_.load(std::memory_order_relaxed);
  }

 private:
  std::array<std::uint8_t, Size> bytes_{};
  // Both count on and on; what is between them is in the ring.
  std::atomic<std::uint32_t> begin_{0};
  std::atomic<std::uint32_t> end_{0};
  std::atomic<std::uint32_t> overruns_{0};
};
