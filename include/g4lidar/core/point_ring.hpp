// SPDX-License-Identifier: MIT
// Passes points between threads: one producer that never waits, any number of readers.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "g4lidar/point.hpp"

namespace g4lidar {

/// A 64-bit count that one thread increases and any thread reads, in words of type `Word`: the
/// widest type that the processor loads and stores atomically.
///
/// With 32-bit words, the count is a low word between two copies of the high word. They are written
/// from the last copy to the first and read from the first to the last. If a reader finds equal
/// copies, there was no carry during its load; otherwise the low word shows the reader on which
/// side of the carry it was read. No thread waits, not even a reader that interrupted the producer
/// in the middle of a carry. The value is exact as long as the count increases by less than
/// 2,147,483,648 during one load: 66 hours of a G4.
template <class Word>
class published_count {
 public:
  /// Starts at `value`.
  explicit constexpr published_count(std::uint64_t value) noexcept
      : high_first_(high_of(value)), low_(static_cast<Word>(value)), high_last_(high_of(value)) {}

  /// The producer only. A reader that sees this value also sees what the producer wrote before.
  void store(std::uint64_t value) noexcept {
    if constexpr (sizeof(Word) < sizeof(value)) {
      high_last_.store(high_of(value), std::memory_order_release);
      low_.store(static_cast<Word>(value), std::memory_order_release);
      high_first_.store(high_of(value), std::memory_order_release);
    } else {
      low_.store(static_cast<Word>(value), std::memory_order_release);
    }
  }

  /// Any thread.
  [[nodiscard]] std::uint64_t load() const noexcept {
    if constexpr (sizeof(Word) < sizeof(std::uint64_t)) {
      const Word before = high_first_.load(std::memory_order_acquire);
      const Word low = low_.load(std::memory_order_acquire);
      const Word after = high_last_.load(std::memory_order_acquire);
      return join(before, low, after);
    } else {
      return low_.load(std::memory_order_acquire);
    }
  }

  /// The count from these three 32-bit words: during a carry, a large low word was read before the
  /// carry. *Pure.*
  [[nodiscard]] static constexpr std::uint64_t join(std::uint32_t before, std::uint32_t low,
                                                    std::uint32_t after) noexcept {
    const std::uint32_t high = low >> 31 != 0 ? before : after;
    return static_cast<std::uint64_t>(high) << 32 | low;
  }

 private:
  [[nodiscard]] static constexpr Word high_of(std::uint64_t value) noexcept {
    return static_cast<Word>(value >> 32);
  }

  std::atomic<Word> high_first_;
  std::atomic<Word> low_;
  std::atomic<Word> high_last_;
};

/// Whether a `Word` is loaded and stored atomically, which is all that the ring requires. A
/// Cortex-M0 does that with 32 bits, although its atomics are not lock-free (it has no
/// read-modify-write).
template <class Word>
inline constexpr bool loads_and_stores_in_one_go =
#if defined(__ARM_ARCH_6M__) && !defined(__clang__)
    sizeof(Word) <= sizeof(std::uint32_t);
#else
    std::atomic<Word>::is_always_lock_free;
#endif

/// The widest word with plain lock-free loads and stores on this processor.
using ring_word = std::conditional_t<std::atomic<std::uint64_t>::is_always_lock_free, std::uint64_t,
                                     std::uint32_t>;

/// The result of a read.
struct ring_read {
  std::size_t points = 0;    ///< Points written to the front of the reader's memory.
  std::uint64_t missed = 0;  ///< Points that were overwritten before this reader read them.
};

namespace detail {

/// The memory of a ring, whose size is known to the compiler.
template <class Slot, std::size_t Capacity>
class ring_memory {
  static_assert(std::has_single_bit(Capacity) && Capacity >= 2,
                "the capacity of a point_ring is a power of two, at least 2");

 public:
  [[nodiscard]] static constexpr std::size_t size() noexcept { return Capacity; }
  [[nodiscard]] Slot* data() noexcept { return slots_.data(); }
  [[nodiscard]] const Slot* data() const noexcept { return slots_.data(); }

 private:
  std::array<Slot, Capacity> slots_{};
};
/// That of the caller.
template <class Slot>
class ring_memory<Slot, std::dynamic_extent> {
 public:
  constexpr explicit ring_memory(std::span<Slot> slots) noexcept : slots_(slots) {
    assert(std::has_single_bit(slots.size()) && slots.size() >= 2);
  }
  [[nodiscard]] std::size_t size() const noexcept { return slots_.size(); }
  [[nodiscard]] Slot* data() noexcept { return slots_.data(); }
  [[nodiscard]] const Slot* data() const noexcept { return slots_.data(); }

 private:
  std::span<Slot> slots_;
};

}  // namespace detail

/// A ring of the last `Capacity` points. With std::dynamic_extent the caller gives the memory. *One
/// producer, any number of readers, never allocates.*
///
/// The producer never waits and never fails: when the ring is full, it overwrites the oldest
/// points. Each reader gets the exact number of points that it missed; at all times, points read +
/// points missed + points available = points written since the reader was created. A point is never
/// torn.
///
/// Method: before the producer writes points, it publishes how far it will write (`claimed_`), and
/// afterwards how far it has written (`written_`). A reader copies and then loads `claimed_`:
/// points that the producer may have overwritten since are removed from the copy and counted as
/// missed. Each word of a point is an atomic that is stored with release and loaded with acquire,
/// so a reader that has seen any word of a newer point also sees the claim made before it; no
/// fences are needed.
template <std::size_t Capacity, class Word = ring_word>
class point_ring {
  static_assert(loads_and_stores_in_one_go<Word>);

 public:
  class reader;
  /// The memory of a point.
  using slot = std::array<std::atomic<Word>, sizeof(point) / sizeof(Word)>;

  /// `first` is the number of the first point, for tests of the wrap of the counters.
  explicit constexpr point_ring(std::uint64_t first = 0) noexcept
    requires(Capacity != std::dynamic_extent)
      : next_(first), claimed_(first), written_(first) {}
  /// In `memory` for a power of two of points, at least 2, which outlives the ring.
  explicit constexpr point_ring(std::span<slot> memory, std::uint64_t first = 0) noexcept
    requires(Capacity == std::dynamic_extent)
      : next_(first), claimed_(first), written_(first), slots_(memory) {}
  point_ring(const point_ring&) = delete;
  point_ring& operator=(const point_ring&) = delete;

  /// Appends points. For the producer only. Never waits.
  void push(std::span<const point> points) noexcept {
    while (!points.empty()) {
      const std::size_t begin = place_of(next_);
      const std::size_t count = std::min({points.size(), batch, slots_.size() - begin});
      claimed_.store(next_ + count);
      slot* to = slots_.data() + begin;
#pragma GCC unroll 8
      for (const point& p : points.first(count)) store(*to++, p);
      next_ += count;
      written_.store(next_);
      points = points.subspan(count);
    }
  }
  /// Appends one point. For the producer only. Never waits.
  void push(const point& p) noexcept { push(std::span<const point, 1>(&p, 1)); }

  /// The number of points written, counted from the constructor's `first`. Any thread.
  [[nodiscard]] std::uint64_t written() const noexcept { return written_.load(); }

  /// A reader that begins with the next point to be written. Any thread; the reader itself is for
  /// one thread at a time and must not outlive the ring.
  [[nodiscard]] reader make_reader() const& noexcept { return reader(*this, written()); }
  /// Deleted: the reader would outlive the ring.
  reader make_reader() const&& = delete;

 private:
  static constexpr std::size_t words = sizeof(point) / sizeof(Word);
  /// Points claimed at a time: few, so that a reader close to the producer loses few.
  static constexpr std::size_t batch = std::min<std::size_t>(Capacity, 64);
  using point_words = std::array<Word, words>;

  [[nodiscard]] std::size_t place_of(std::uint64_t number) const noexcept {
    return static_cast<std::size_t>(number) & (slots_.size() - 1);
  }
  static void store(slot& to, const point& p) noexcept {
    const auto* const raw = reinterpret_cast<const unsigned char*>(&p);
#pragma GCC unroll 8
    for (std::size_t i = 0; i < words; ++i) {
      Word word;  // one by one: a compiler would put an array of them on the stack
      std::memcpy(&word, raw + i * sizeof(Word), sizeof(Word));
      to[i].store(word, std::memory_order_release);
    }
  }
  [[nodiscard]] point load(std::uint64_t number) const noexcept {
    point_words raw;
    const slot& from = slots_.data()[place_of(number)];
#pragma GCC unroll 8
    for (std::size_t i = 0; i < words; ++i) raw[i] = from[i].load(std::memory_order_acquire);
    return std::bit_cast<point>(raw);
  }

  std::uint64_t next_;  // used by the producer only
  published_count<Word> claimed_;
  published_count<Word> written_;
  detail::ring_memory<slot, Capacity> slots_;
};

/// The position of one reader in a ring. *Single thread at a time.*
template <std::size_t Capacity, class Word>
class point_ring<Capacity, Word>::reader {
 public:
  /// Copies the oldest points that this reader has not read to the front of `out`: as many as there
  /// are and as fit. Never waits.
  [[nodiscard]] ring_read read(std::span<point> out) noexcept {
    ring_read result;
    const std::uint64_t written = ring_->written();
    skip_overwritten(written, result);
    const auto count =
        static_cast<std::size_t>(std::min<std::uint64_t>(written - place_, out.size()));
    for (std::size_t i = 0; i < count; ++i) out[i] = ring_->load(place_ + i);
    const std::uint64_t from = place_;
    skip_overwritten(ring_->claimed_.load(), result);
    // Points that the producer may have overwritten during the copy are removed from its front.
    const auto dropped = static_cast<std::size_t>(std::min<std::uint64_t>(place_ - from, count));
    std::copy(out.begin() + static_cast<std::ptrdiff_t>(dropped),
              out.begin() + static_cast<std::ptrdiff_t>(count), out.begin());
    result.points = count - dropped;
    place_ += result.points;
    return result;
  }

  /// The number of points that can be read now, if the producer does not overwrite them before.
  [[nodiscard]] std::uint64_t ahead() const noexcept { return ring_->written() - place_; }

 private:
  friend class point_ring;

  reader(const point_ring& ring, std::uint64_t place) noexcept : ring_(&ring), place_(place) {}

  /// Advances to the oldest point that is still intact when the producer has reached `frontier`.
  /// The numbers are compared by their difference, so they may wrap.
  void skip_overwritten(std::uint64_t frontier, ring_read& result) noexcept {
    const std::uint64_t distance = frontier - place_;
    if (distance <= ring_->slots_.size()) return;
    const std::uint64_t gone = distance - ring_->slots_.size();
    result.missed += gone;
    place_ += gone;
  }

  const point_ring* ring_;
  std::uint64_t place_;
};

}  // namespace g4lidar
