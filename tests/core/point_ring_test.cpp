// SPDX-License-Identifier: MIT
// The ring in one thread: what is read, what is missed, and the wrap of its counters. The same
// tests for words of 64 and of 32 bits.
#include "g4lidar/core/point_ring.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace g4lidar {
namespace {

/// A point that contains its number.
point numbered(std::uint64_t number) {
  point p;
  p.range_mm = static_cast<float>(number % 4096);
  p.time_ns = static_cast<std::int64_t>(number);
  p.revolution = static_cast<std::uint32_t>(number >> 5);
  return p;
}

std::vector<point> numbered(std::uint64_t first, std::size_t count) {
  std::vector<point> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back(numbered(first + i));
  return points;
}

/// Reads all points, `piece` points at a time; the numbers read, and how many were missed.
template <class Reader>
std::vector<point> read_all(Reader& reader, std::uint64_t& missed, std::size_t piece = 7) {
  std::vector<point> all;
  std::vector<point> out(piece);
  while (true) {
    const ring_read got = reader.read(out);
    missed += got.missed;
    if (got.points == 0) return all;
    all.insert(all.end(), out.begin(), out.begin() + static_cast<std::ptrdiff_t>(got.points));
  }
}

template <class Word>
class PointRing : public testing::Test {};
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
TYPED_TEST_SUITE(PointRing, words, word_names);

TYPED_TEST(PointRing, ReturnsPushedPointsInOrder) {
  point_ring<64, TypeParam> ring;
  auto reader = ring.make_reader();
  ring.push(numbered(0, 40));
  ring.push(numbered(40));
  EXPECT_EQ(ring.written(), 41U);
  EXPECT_EQ(reader.ahead(), 41U);
  std::uint64_t missed = 0;
  EXPECT_EQ(read_all(reader, missed), numbered(0, 41));
  EXPECT_EQ(missed, 0U);
  EXPECT_EQ(reader.ahead(), 0U);
}

TYPED_TEST(PointRing, EmptyReadsAndPushesChangeNothing) {
  point_ring<4, TypeParam> ring;
  auto reader = ring.make_reader();
  std::vector<point> out(4);
  EXPECT_EQ(reader.read(out).points, 0U);
  ring.push(std::span<const point>());
  EXPECT_EQ(ring.written(), 0U);
  ring.push(numbered(0));
  const ring_read nowhere = reader.read(std::span<point>());
  EXPECT_EQ(nowhere.points, 0U);
  EXPECT_EQ(nowhere.missed, 0U);
  EXPECT_EQ(reader.ahead(), 1U);
}

TYPED_TEST(PointRing, ReadsNoMoreThanFits) {
  point_ring<16, TypeParam> ring;
  auto reader = ring.make_reader();
  ring.push(numbered(0, 10));
  const point untouched = numbered(999);
  std::vector<point> out(8, untouched);
  EXPECT_EQ(reader.read(std::span(out).first(3)).points, 3U);
  EXPECT_EQ(out[2], numbered(2));
  EXPECT_EQ(out[3], untouched);
  EXPECT_EQ(reader.read(out).points, 7U);
  EXPECT_EQ(out[6], numbered(9));
  EXPECT_EQ(out[7], untouched);
}

TYPED_TEST(PointRing, FullRing_IsReadCompletely) {
  point_ring<64, TypeParam> ring;
  auto reader = ring.make_reader();
  ring.push(numbered(0, 64));
  std::uint64_t missed = 0;
  EXPECT_EQ(read_all(reader, missed), numbered(0, 64));
  EXPECT_EQ(missed, 0U);
}

TYPED_TEST(PointRing, OldestAreOverwrittenAndCounted) {
  point_ring<64, TypeParam> ring;
  auto reader = ring.make_reader();
  ring.push(numbered(0, 65));
  std::vector<point> out(64);
  const ring_read got = reader.read(out);
  EXPECT_EQ(got.missed, 1U);
  EXPECT_EQ(got.points, 64U);
  EXPECT_EQ(out, numbered(1, 64));
}

TYPED_TEST(PointRing, PushLargerThanTheRing) {
  point_ring<8, TypeParam> ring;
  auto reader = ring.make_reader();
  ring.push(numbered(0, 1000));
  std::uint64_t missed = 0;
  EXPECT_EQ(read_all(reader, missed), numbered(992, 8));
  EXPECT_EQ(missed, 992U);
  EXPECT_EQ(ring.written(), 1000U);
}

TYPED_TEST(PointRing, SmallestRing) {
  point_ring<2, TypeParam> ring;
  auto reader = ring.make_reader();
  std::uint64_t missed = 0;
  ring.push(numbered(0));
  EXPECT_EQ(read_all(reader, missed), numbered(0, 1));
  ring.push(numbered(1, 2));
  EXPECT_EQ(read_all(reader, missed, 1), numbered(1, 2));
  EXPECT_EQ(missed, 0U);
  ring.push(numbered(3, 5));
  EXPECT_EQ(read_all(reader, missed), numbered(6, 2));
  EXPECT_EQ(missed, 3U);
}

TYPED_TEST(PointRing, Reader_BeginsWithTheNextPoint) {
  point_ring<8, TypeParam> ring;
  ring.push(numbered(0, 5));
  auto reader = ring.make_reader();
  std::uint64_t missed = 0;
  EXPECT_TRUE(read_all(reader, missed).empty());
  ring.push(numbered(5, 2));
  EXPECT_EQ(read_all(reader, missed), numbered(5, 2));
  EXPECT_EQ(missed, 0U);
}

TYPED_TEST(PointRing, EachReader_HasItsOwnPosition) {
  point_ring<16, TypeParam> ring;
  auto quick = ring.make_reader();
  auto slow = ring.make_reader();
  std::uint64_t quick_missed = 0;
  std::uint64_t slow_missed = 0;
  for (std::uint64_t number = 0; number < 160; number += 10) {
    ring.push(numbered(number, 10));
    EXPECT_EQ(read_all(quick, quick_missed), numbered(number, 10));
  }
  EXPECT_EQ(quick_missed, 0U);
  EXPECT_EQ(read_all(slow, slow_missed), numbered(144, 16));
  EXPECT_EQ(slow_missed, 144U);
}

TYPED_TEST(PointRing, CopyOfAReader_ContinuesFromTheSamePosition) {
  point_ring<16, TypeParam> ring;
  auto reader = ring.make_reader();
  ring.push(numbered(0, 4));
  std::vector<point> out(2);
  ASSERT_EQ(reader.read(out).points, 2U);
  auto copy = reader;
  std::uint64_t missed = 0;
  EXPECT_EQ(read_all(reader, missed), numbered(2, 2));
  EXPECT_EQ(read_all(copy, missed), numbered(2, 2));
  EXPECT_EQ(missed, 0U);
}

TYPED_TEST(PointRing, CountersWrapWithoutError) {
  // Before a carry of the low word, before a wrap of the whole count, and at other edges.
  for (const std::uint64_t edge :
       {std::uint64_t{1} << 16, std::uint64_t{1} << 31, std::uint64_t{1} << 32,
        std::uint64_t{5} << 32, std::uint64_t{1} << 63, std::uint64_t{0}}) {
    for (const std::uint64_t before : {1U, 31U, 32U, 33U, 100U}) {
      const std::uint64_t first = edge - before;
      point_ring<64, TypeParam> ring(first);
      auto reader = ring.make_reader();
      auto slow = ring.make_reader();
      EXPECT_EQ(ring.written(), first);
      std::uint64_t missed = 0;
      for (std::uint64_t at = 0; at < 210; at += 21) {
        ring.push(numbered(first + at, 21));
        EXPECT_EQ(reader.ahead(), 21U);
        EXPECT_EQ(read_all(reader, missed), numbered(first + at, 21));
      }
      EXPECT_EQ(missed, 0U);
      EXPECT_EQ(ring.written(), first + 210);
      EXPECT_EQ(slow.ahead(), 210U);
      EXPECT_EQ(read_all(slow, missed), numbered(first + 146, 64));
      EXPECT_EQ(missed, 146U);
    }
  }
}

// The size of the memory is not known to the compiler: what the other tests show of a ring of 8.
TEST(RingInMemoryOfTheCaller, HoldsAsMuchAsTheMemory) {
  using ring = point_ring<std::dynamic_extent>;
  std::vector<ring::slot> memory(8);
  ring points(memory, 5);
  auto reader = points.make_reader();
  points.push(numbered(0, 3));
  std::uint64_t missed = 0;
  EXPECT_EQ(read_all(reader, missed), numbered(0, 3));
  EXPECT_EQ(missed, 0U);
  points.push(numbered(3, 20));
  EXPECT_EQ(reader.ahead(), 20U);
  EXPECT_EQ(read_all(reader, missed), numbered(15, 8));
  EXPECT_EQ(missed, 12U);
  EXPECT_EQ(points.written(), 28U);
}

TEST(PublishedCount, HoldsEveryValue) {
  for (const std::uint64_t value :
       {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{0xFFFFFFFF}, std::uint64_t{0x100000000},
        std::uint64_t{0x123456789ABCDEF0}, ~std::uint64_t{0}}) {
    published_count<std::uint32_t> count(value);
    EXPECT_EQ(count.load(), value);
    count.store(value + 1);
    EXPECT_EQ(count.load(), value + 1);
  }
}

TEST(PublishedCount, ReadDuringACarry_DoesNotWait) {
  using narrow = published_count<std::uint32_t>;
  // The words after each of the three stores of 0x7'FFFFFFF0 -> 0x8'00000010: last copy, low word,
  // first copy.
  static_assert(narrow::join(7, 0xFFFFFFF0, 7) == 0x7FFFFFFF0);
  static_assert(narrow::join(7, 0xFFFFFFF0, 8) == 0x7FFFFFFF0);
  static_assert(narrow::join(7, 0x00000010, 8) == 0x800000010);
  static_assert(narrow::join(8, 0x00000010, 8) == 0x800000010);
  // The same where all 64 bits wrap.
  static_assert(narrow::join(0xFFFFFFFF, 0xFFFFFFF0, 0) == 0xFFFFFFFFFFFFFFF0);
  static_assert(narrow::join(0xFFFFFFFF, 0x00000010, 0) == 0x10);
}

}  // namespace
}  // namespace g4lidar
