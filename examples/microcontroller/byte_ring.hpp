// SPDX-License-Identifier: MIT
// Bytes from a receive interrupt to the main loop, without a lock and without disabling interrupts.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

/// A first-in, first-out ring of `Size` bytes, a power of two. One producer: the interrupt. One
/// consumer: the main loop. A byte without room is dropped and counted. A G4 sends up to 23 bytes
/// per millisecond, so `Size` / 23 is the time in milliseconds that the main loop may need for
/// other work.
template <std::size_t Size>
class byte_ring {
  static_assert(std::has_single_bit(Size));
  static_assert(std::atomic<std::uint32_t>::is_always_lock_free);

 public:
  /// For the producer only.
  void push(std::uint8_t byte) noexcept {
    const std::uint32_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == Size) {
      overruns_.store(overruns_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
      return;
    }
    bytes_[end % Size] = byte;
    end_.store(end + 1, std::memory_order_release);
  }

  /// For the consumer only: moves the available bytes, as many as fit, to the front of `out`;
  /// returns them.
  [[nodiscard]] std::span<const std::uint8_t> take(std::span<std::uint8_t> out) noexcept {
    const std::uint32_t begin = begin_.load(std::memory_order_relaxed);
    const std::size_t there = end_.load(std::memory_order_acquire) - begin;
    const std::size_t count = std::min(there, out.size());
    for (std::size_t i = 0; i < count; ++i) out[i] = bytes_[(begin + i) % Size];
    begin_.store(begin + static_cast<std::uint32_t>(count), std::memory_order_release);
    return out.first(count);
  }

  /// The number of dropped bytes.
  [[nodiscard]] std::uint32_t overruns() const noexcept {
    return overruns_.load(std::memory_order_relaxed);
  }

 private:
  std::array<std::uint8_t, Size> bytes_{};
  // Both only increase; the bytes between them are in the ring.
  std::atomic<std::uint32_t> begin_{0};
  std::atomic<std::uint32_t> end_{0};
  std::atomic<std::uint32_t> overruns_{0};
};
