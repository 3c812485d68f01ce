// SPDX-License-Identifier: MIT
// The ring at full speed: one writer, three readers, every torn point is detected, every point is
// read or counted as missed. Also run with the thread sanitizer.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <barrier>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include "g4lidar/core/point_ring.hpp"
#include "support/test_scale.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;

const auto scale = [] { return static_cast<std::uint64_t>(test::test_scale()); };

using point_words = std::array<std::uint32_t, sizeof(point) / 4>;

/// A point in which every word follows from its number and differs from that of its neighbours: a
/// mixture of two points has no number.
point_words words_of(std::uint64_t number) {
  point_words words;
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] = static_cast<std::uint32_t>(number * 0x9E3779B1U + i * 0x85EBCA77U);
  }
  return words;
}

/// The results of one reader.
struct account {
  std::uint64_t read = 0;
  std::uint64_t missed = 0;
  std::uint64_t wrong = 0;  ///< Torn, repeated or out of place.
  bool overtook = false;    ///< A point was read before it was written.
};

/// Reads the available points, up to the size of `out`, and compares each point with its expected
/// number.
template <class Reader>
std::size_t take(Reader& reader, std::span<point> out, std::uint64_t first, account& sum) {
  const ring_read got = reader.read(out);
  sum.missed += got.missed;
  for (const point& p : out.first(got.points)) {
    const std::uint64_t number = first + sum.read + sum.missed;
    if (std::bit_cast<point_words>(p) != words_of(number)) ++sum.wrong;
    ++sum.read;
  }
  return got.points;
}

/// One writer pushes `total` points from the number `first` on, in pushes of all sizes up to
/// `longest_push`, while three readers with different read sizes read.
template <std::size_t Capacity, class Word>
void run(std::uint64_t first, std::uint64_t total, std::size_t longest_push) {
  const auto ring = std::make_unique<point_ring<Capacity, Word>>(first);
  std::atomic<bool> done{false};
  std::barrier start(4);
  std::array<account, 3> accounts;

  const auto read = [&](std::size_t habit) {
    auto reader = ring->make_reader();
    account sum;
    std::vector<point> out(habit == 1 ? 1 : Capacity);
    start.arrive_and_wait();
    for (std::uint64_t round = 0;; ++round) {
      const bool last = done.load();  // before the read: everything written before it is available
      const std::size_t count = take(reader, out, first, sum);
      if (sum.read + sum.missed > total) sum.overtook = true;
      if (last && count == 0) break;
      if (habit == 2 && round % 64 == 0) std::this_thread::sleep_for(20us);
    }
    accounts[habit] = sum;
  };
  std::vector<std::thread> readers;
  for (std::size_t habit = 0; habit < accounts.size(); ++habit) readers.emplace_back(read, habit);

  std::vector<point> batch(longest_push);
  start.arrive_and_wait();
  std::size_t size = 1;
  for (std::uint64_t sent = 0; sent < total;) {
    size = size % longest_push + 1;
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(size, total - sent));
    for (std::size_t i = 0; i < count; ++i) {
      batch[i] = std::bit_cast<point>(words_of(first + sent + i));
    }
    ring->push(std::span<const point>(batch).first(count));
    sent += count;
  }
  done = true;
  for (std::thread& reader : readers) reader.join();

  EXPECT_EQ(ring->written(), first + total);
  for (std::size_t habit = 0; habit < accounts.size(); ++habit) {
    SCOPED_TRACE("reader " + std::to_string(habit));
    EXPECT_EQ(accounts[habit].wrong, 0U);
    EXPECT_FALSE(accounts[habit].overtook);
    EXPECT_EQ(accounts[habit].read + accounts[habit].missed, total);
    EXPECT_GE(accounts[habit].read, std::min<std::uint64_t>(Capacity, total));
  }
  // A test in which no reader was ever overtaken would show nothing.
  EXPECT_GT(accounts[0].missed + accounts[1].missed + accounts[2].missed, 0U);
}

template <class Word>
class RingThreads : public testing::Test {};
struct word_names {
  template <class Word>
  static std::string GetName(int) {
    return sizeof(Word) == 8 ? "64" : "32";
  }
};
// A processor without 64-bit atomics has the 32-bit ring only.
using words =
    std::conditional_t<std::is_same_v<ring_word, std::uint64_t>,
                       testing::Types<std::uint64_t, std::uint32_t>, testing::Types<std::uint32_t>>;
TYPED_TEST_SUITE(RingThreads, words, word_names);

constexpr std::uint64_t low_carry = std::uint64_t{1} << 32;

TYPED_TEST(RingThreads, NoPointIsTorn_EachIsReadOrCounted) {
  run<64, TypeParam>(0, 2'000'000 * scale(), 24);
}

TYPED_TEST(RingThreads, LargeRing_AcrossTheCarryOfTheLowWord) {
  const std::uint64_t total = 2'000'000 * scale();
  run<4096, TypeParam>(low_carry - total / 2, total, 80);
}

TYPED_TEST(RingThreads, SmallRing_AcrossTheWrapOfTheCount) {
  const std::uint64_t total = 1'000'000 * scale();
  run<8, TypeParam>(0 - total / 2, total, 13);
}

TEST(PublishedCountThreads, Load_IsConsistentAcrossACarry) {
  // The carry occurs repeatedly: each round counts across it in small steps.
  constexpr std::uint64_t around = 24;
  const std::uint64_t rounds = 20'000 * scale();
  published_count<std::uint32_t> count(0);
  std::barrier step(2);
  std::uint64_t wrong = 0;
  const auto edge_of = [](std::uint64_t round) { return (round + 1) << 32; };
  std::thread reader([&] {
    for (std::uint64_t round = 0; round < rounds; ++round) {
      step.arrive_and_wait();
      const std::uint64_t end = edge_of(round) + around;
      std::uint64_t last = edge_of(round) - around;
      while (last < end) {
        const std::uint64_t now = count.load();
        if (now < last || now > end) ++wrong;
        last = now;
      }
      step.arrive_and_wait();
    }
  });
  for (std::uint64_t round = 0; round < rounds; ++round) {
    count.store(edge_of(round) - around);
    step.arrive_and_wait();
    for (std::uint64_t i = 1; i <= 2 * around; ++i) count.store(edge_of(round) - around + i);
    step.arrive_and_wait();
  }
  reader.join();
  EXPECT_EQ(wrong, 0U);
}

}  // namespace
}  // namespace g4lidar
