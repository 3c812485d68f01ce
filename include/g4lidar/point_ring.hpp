// SPDX-License-Identifier: MIT
// The hand-over of points between threads: one producer that never waits, any number of readers.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "g4lidar/point.hpp"

namespace g4lidar {

/// A count that one thread moves on and any thread reads: 64 bits wide in words of type `Word`, the
/// widest that the processor loads and stores in one go.
///
/// Where a word is 32 bits, the count lies in a low word between two copies of its high word. It is
/// written from the last copy to the first and read from the first to the last, so a reader that
/// finds both copies the same has not looked across a carry, and one that does not knows by the low
/// word on which side of it that one lies. Nobody waits, not even a reader that has interrupted the
/// producer in the middle of a carry. What is read is exact as long as the producer moves on by less
/// than 2,147,483,648 during one load: 66 hours of a G4.
template <class Word>
class published_count {
 public:
  /// Begins at `value`.
  explicit constexpr published_count(std::uint64_t value) noexcept
      : high_first_(high_of(value)), low_(static_cast<Word>(value)), high_last_(high_of(value)) {}

  /// The producer only. What it wrote before is seen by whoever reads this value.
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

  /// The count that was read as these three 32-bit words: in a carry a low word that is large has not
  /// gone through it yet. *Pure.*
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

/// Whether a `Word` is loaded and stored in one go here, which is all that the ring asks for. A
/// Cortex-M0 does that with 32 bits; for want of a read-modify-write it is not called lock-free.
template <class Word>
inline constexpr bool loads_and_stores_in_one_go =
#if defined(__ARM_ARCH_6M__) && !defined(__clang__)
    sizeof(Word) <= sizeof(std::uint32_t);
#else
    std::atomic<Word>::is_always_lock_free;
#endif

/// The widest word with plain lock-free loads and stores here.
using ring_word = std::conditional_t<std::atomic<std::uint64_t>::is_always_lock_free, std::uint64_t,
                                     std::uint32_t>;

/// What a read brought.
struct ring_read {
  std::size_t points = 0;    ///< Points written to the front of the reader's memory.
  std::uint64_t missed = 0;  ///< Points that were overwritten before this reader came to them.
};

/// A ring of the last `Capacity` points. *One producer, any number of readers, never allocates.*
///
/// The producer never waits and never fails: when the ring is full the oldest points go. A reader
/// that was too slow is told exactly how many points it missed; for each reader at all times, points
/// read + points missed + points ahead = points written since it began. A point is never torn.
///
/// How: before it writes points the producer publishes how far it is about to write (`claimed_`), and
/// after it how far it has written (`written_`). A reader copies and then looks at `claimed_`: what
/// the producer could have touched meanwhile is dropped from the copy and counted as missed. Each
/// word of a point is an atomic stored with release and loaded with acquire, so that a reader which
/// has seen any word of a newer point also sees the claim made before it; no fences are needed.
template <std::size_t Capacity, class Word = ring_word>
class point_ring {
  static_assert(std::has_single_bit(Capacity) && Capacity >= 2,
                "the capacity of a point_ring is a power of two, at least 2");
  static_assert(loads_and_stores_in_one_go<Word>);

 public:
  class reader;

  /// `first` is the number of the first point, for tests of the counters' wrap.
  explicit constexpr point_ring(std::uint64_t first = 0) noexcept
      : next_(first), claimed_(first), written_(first) {}
  point_ring(const point_ring&) = delete;
  point_ring& operator=(const point_ring&) = delete;

  /// Appends points. The producer only. Never waits.
  void push(std::span<const point> points) noexcept {
    while (!points.empty()) {
      const std::size_t begin = static_cast<std::size_t>(next_) % Capacity;
      const std::size_t count = std::min({points.size(), batch, Capacity - begin});
      claimed_.store(next_ + count);
      slot* to = slots_.data() + begin;
#pragma GCC unroll 8
      for (const point& p : points.first(count)) store(*to++, p);
      next_ += count;
      written_.store(next_);
      points = points.subspan(count);
    }
  }
  /// Appends one point. The producer only. Never waits.
  void push(const point& p) noexcept { push(std::span<const point, 1>(&p, 1)); }

  /// How many points have been written, counted from the constructor's `first`. Any thread.
  [[nodiscard]] std::uint64_t written() const noexcept { return written_.load(); }

  /// A reader that begins with the next point to be written. Any thread; the reader itself is for
  /// one thread at a time and must not outlive the ring.
  [[nodiscard]] reader make_reader() const& noexcept { return reader(*this, written()); }
  /// It would outlive the ring.
  reader make_reader() const&& = delete;

 private:
  static constexpr std::size_t words = sizeof(point) / sizeof(Word);
  /// Points claimed at a time: few, so that a reader close behind loses few.
  static constexpr std::size_t batch = std::min<std::size_t>(Capacity, 64);
  using point_words = std::array<Word, words>;
  using slot = std::array<std::atomic<Word>, words>;

  static void store(slot& to, const point& p) noexcept {
    const auto* const raw = reinterpret_cast<const unsigned char*>(&p);
#pragma GCC unroll 8
    for (std::size_t i = 0; i < words; ++i) {
      Word word;  // one by one: an array of them would go by way of the stack
      std::memcpy(&word, raw + i * sizeof(Word), sizeof(Word));
      to[i].store(word, std::memory_order_release);
    }
  }
  [[nodiscard]] point load(std::uint64_t number) const noexcept {
    point_words raw;
    const slot& from = slots_[static_cast<std::size_t>(number % Capacity)];
#pragma GCC unroll 8
    for (std::size_t i = 0; i < words; ++i) raw[i] = from[i].load(std::memory_order_acquire);
    return std::bit_cast<point>(raw);
  }

  std::uint64_t next_;  // the producer's own
  published_count<Word> claimed_;
  published_count<Word> written_;
  std::array<slot, Capacity> slots_{};
};

/// One reader's place in a ring. *Single thread at a time.*
template <std::size_t Capacity, class Word>
class point_ring<Capacity, Word>::reader {
 public:
  /// Takes the oldest points that this reader has not read into the front of `out`, as many as there
  /// are and fit. Never waits.
  [[nodiscard]] ring_read read(std::span<point> out) noexcept {
    ring_read result;
    const std::uint64_t written = ring_->written();
    skip_overwritten(written, result);
    const auto count =
        static_cast<std::size_t>(std::min<std::uint64_t>(written - place_, out.size()));
    for (std::size_t i = 0; i < count; ++i) out[i] = ring_->load(place_ + i);
    const std::uint64_t from = place_;
    skip_overwritten(ring_->claimed_.load(), result);
    // What the producer may have written over while it was copied is dropped from the front.
    const auto dropped = static_cast<std::size_t>(std::min<std::uint64_t>(place_ - from, count));
    std::copy(out.begin() + static_cast<std::ptrdiff_t>(dropped),
              out.begin() + static_cast<std::ptrdiff_t>(count), out.begin());
    result.points = count - dropped;
    place_ += result.points;
    return result;
  }

  /// How many points can be read now, if the producer is not faster.
  [[nodiscard]] std::uint64_t ahead() const noexcept { return ring_->written() - place_; }

 private:
  friend class point_ring;

  reader(const point_ring& ring, std::uint64_t place) noexcept : ring_(&ring), place_(place) {}

  /// Moves on to the oldest point still whole when the producer has got as far as `frontier`. The
  /// numbers are compared by their distance, so they may wrap.
  void skip_overwritten(std::uint64_t frontier, ring_read& result) noexcept {
    const std::uint64_t distance = frontier - place_;
    if (distance <= Capacity) return;
    const std::uint64_t gone = distance - Capacity;
    result.missed += gone;
    place_ += gone;
  }

  const point_ring* ring_;
  std::uint64_t place_;
};

}  // namespace g4lidar
