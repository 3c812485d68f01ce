// SPDX-License-Identifier: MIT
// A queue of at most N elements in place: the buffers of a device are bounded.
#pragma once

#include <array>
#include <cstddef>

namespace g4lidar::sim {

template <class T, std::size_t N>
class ring {
 public:
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] bool full() const noexcept { return size_ == N; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  void clear() noexcept { size_ = 0; }

  [[nodiscard]] T& front() noexcept { return items_[first_]; }
  [[nodiscard]] const T& front() const noexcept { return items_[first_]; }
  /// Keeps only the oldest ones, at most this many.
  void keep(std::size_t count) noexcept { size_ = count < size_ ? count : size_; }
  /// The queue must not be empty.
  void pop() noexcept {
    first_ = (first_ + 1) % N;
    --size_;
  }
  /// A new last element, with undefined content; the queue must not be full.
  T& push() noexcept { return items_[(first_ + size_++) % N]; }
  /// Returns whether there was room.
  bool push(const T& item) noexcept {
    if (full()) return false;
    push() = item;
    return true;
  }

 private:
  std::array<T, N> items_{};
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace g4lidar::sim
