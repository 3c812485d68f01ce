// SPDX-License-Identifier: MIT
// The ring interrupted at every single word: an atomic that lets a test interrupt between any two
// loads or stores, like an interrupt or another processor, and that requires the memory orders.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "g4lidar/core/point_ring.hpp"

namespace probe {

/// A 32-bit word whose atomic reports its operations.
struct word {
  std::uint32_t value = 0;
  constexpr word() = default;
  explicit constexpr word(std::uint64_t wide) : value(static_cast<std::uint32_t>(wide)) {}
  constexpr operator std::uint32_t() const { return value; }
};

/// Counts the loads and stores, and interrupts after the requested ones.
struct stage {
  std::size_t operations = 0;
  bool inside = false;          ///< An interruption is running and is not interrupted itself.
  std::size_t wrong_order = 0;  ///< Loads that do not acquire, stores that do not release.
  std::vector<std::size_t> when;
  void (*interruption)(void*) = nullptr;
  void* with = nullptr;

  void passed(bool right_order) {
    if (!right_order) ++wrong_order;
    if (inside) return;
    const std::size_t now = operations++;
    for (const std::size_t at : when) {
      if (at != now) continue;
      inside = true;
      interruption(with);
      inside = false;
    }
  }
};
inline stage the_stage;

}  // namespace probe

template <>
struct std::atomic<probe::word> {
  static constexpr bool is_always_lock_free = true;
  constexpr atomic() = default;
  constexpr atomic(probe::word first) : held_(first) {}
  void store(probe::word given, std::memory_order order) {
    held_ = given;
    probe::the_stage.passed(order == std::memory_order_release);
  }
  probe::word load(std::memory_order order) const {
    const probe::word seen = held_;
    probe::the_stage.passed(order == std::memory_order_acquire);
    return seen;
  }

 private:
  probe::word held_;
};

namespace g4lidar {
namespace {

using point_words = std::array<std::uint32_t, sizeof(point) / 4>;

/// Every word follows from the number, so that a mixture of two points is invalid.
point numbered(std::uint64_t number) {
  point_words words;
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] = static_cast<std::uint32_t>(number * 0x9E3779B1U + i * 0x85EBCA77U);
  }
  return std::bit_cast<point>(words);
}

/// A ring with a writer and a reader, each of which checks the other one.
template <std::size_t Capacity>
class pair_of {
 public:
  explicit pair_of(std::uint64_t first)
      : ring_(first), reader_(ring_.make_reader()), next_(first), place_(first) {}

  void push(std::size_t count) {
    std::vector<point> points;
    for (std::size_t i = 0; i < count; ++i) points.push_back(numbered(next_ + i));
    next_ += count;
    ring_.push(points);
  }
  /// Reads once. Returns the number of points read.
  std::size_t read() {
    std::array<point, 2 * Capacity> out;
    const ring_read got = reader_.read(out);
    place_ += got.missed;
    for (const point& p : std::span(out).first(got.points)) {
      if (std::bit_cast<point_words>(p) != std::bit_cast<point_words>(numbered(place_))) ++wrong_;
      ++place_;
    }
    if (next_ - place_ > std::uint64_t{1} << 32) ++wrong_;  // more than was ever written
    return got.points;
  }
  /// Whether every written point has been read correctly or counted, once everything has been read.
  [[nodiscard]] bool adds_up() {
    while (read() > 0) {
    }
    return wrong_ == 0 && place_ == next_ && ring_.written() == next_ && reader_.ahead() == 0;
  }

 private:
  point_ring<Capacity, probe::word> ring_;
  typename point_ring<Capacity, probe::word>::reader reader_;
  std::uint64_t next_;   // number of the next point to be pushed
  std::uint64_t place_;  // number of the next point to be read
  std::size_t wrong_ = 0;
};

/// Runs `work`, and `interruption` after each of its operations named in `when`. Returns the number
/// of operations.
template <class Work, class Interruption>
std::size_t interrupt(std::vector<std::size_t> when, Work&& work, Interruption&& interruption) {
  using target = std::remove_reference_t<Interruption>;
  probe::the_stage = {};
  probe::the_stage.when = std::move(when);
  probe::the_stage.interruption = [](void* with) { (*static_cast<target*>(with))(); };
  probe::the_stage.with = &interruption;
  work();
  EXPECT_EQ(probe::the_stage.wrong_order, 0U);
  const std::size_t operations = probe::the_stage.operations;
  probe::the_stage = {};
  return operations;
}

/// The first number, so that `before` points later nothing special, the carry of the low word, or
/// the wrap of the count happens.
std::vector<std::uint64_t> starts(std::uint64_t before) {
  return {1000, (std::uint64_t{1} << 32) - before, 0 - before};
}

TEST(RingInterleaving, ReaderInterruptsAPushAnywhere) {
  for (const std::uint64_t first : starts(30)) {
    for (const std::size_t size : {1U, 3U, 8U, 20U}) {
      std::size_t operations = 1;
      for (std::size_t at = 0; at < operations; ++at) {
        pair_of<8> both(first);
        both.push(25);  // full, and one push before the edge
        operations = interrupt({at}, [&] { both.push(size); }, [&] { both.read(); });
        ASSERT_TRUE(both.adds_up()) << "push of " << size << " interrupted at " << at;
      }
      ASSERT_GT(operations, 6 * size);
    }
  }
}

TEST(RingInterleaving, ReaderInterruptsRepeatedly) {
  for (const std::uint64_t first : starts(30)) {
    for (std::size_t every = 1; every < 30; ++every) {
      std::vector<std::size_t> when;
      for (std::size_t at = 0; at < 2000; at += every) when.push_back(at);
      pair_of<8> both(first);
      interrupt(
          when,
          [&] {
            for (int i = 0; i < 12; ++i) both.push(5);
          },
          [&] { both.read(); });
      ASSERT_TRUE(both.adds_up()) << "interrupted every " << every;
    }
  }
}

TEST(RingInterleaving, WriterInterruptsAReadAnywhere) {
  for (const std::uint64_t first : starts(12)) {
    for (const std::size_t size : {1U, 2U, 7U, 8U, 9U, 40U}) {
      for (const std::size_t ahead : {0U, 1U, 5U, 8U, 11U}) {
        std::size_t operations = 1;
        for (std::size_t at = 0; at < operations; ++at) {
          pair_of<8> both(first);
          both.push(ahead);
          operations = interrupt({at}, [&] { both.read(); }, [&] { both.push(size); });
          ASSERT_TRUE(both.adds_up()) << "read of " << ahead << " interrupted at " << at;
        }
      }
    }
  }
}

TEST(RingInterleaving, WriterInterruptsAReadTwice) {
  for (const std::uint64_t first : starts(9)) {
    std::size_t operations = 1;
    for (std::size_t one = 0; one < operations; ++one) {
      for (std::size_t two = one; two < operations; ++two) {
        pair_of<8> both(first);
        both.push(8);
        operations = interrupt({one, two}, [&] { both.read(); }, [&] { both.push(3); });
        ASSERT_TRUE(both.adds_up()) << "interrupted at " << one << " and " << two;
      }
    }
  }
}

TEST(RingInterleaving, ReaderCloseBehindALargePush_LosesFew) {
  // Points are claimed 64 at a time, so most of a large ring can be read in the middle of a push.
  std::size_t operations = 1;
  for (std::size_t at = 0; at < operations; at += 13) {
    pair_of<128> both(0);
    both.push(128);
    std::size_t read = 0;
    operations = interrupt({at}, [&] { both.push(128); }, [&] { read = both.read(); });
    ASSERT_GE(read, 128U - 64U) << "interrupted at " << at;
    ASSERT_TRUE(both.adds_up());
  }
}

}  // namespace
}  // namespace g4lidar
