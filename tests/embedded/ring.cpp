// SPDX-License-Identifier: MIT
// The ring with its counts in words of 32 bits: every point is read or counted as missed, also at a
// carry of the low word and at a wrap of the whole count.
#include "g4lidar/core/point_ring.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "check.hpp"

namespace self_test {
namespace {

using namespace g4lidar;

constexpr std::uint64_t carry = 0x100000000;

void test_published_count() {
  constexpr std::array<std::uint64_t, 8> values{
      0, 1, carry - 1, carry, carry + 1, ~carry, 7 * carry - 1, ~std::uint64_t{0}};
  published_count<std::uint32_t> count(carry - 2);
  check(count.load() == carry - 2);
  for (const std::uint64_t value : values) {
    count.store(unknown(value));
    check(count.load() == value);
  }
}

point numbered(std::uint64_t number) {
  point p;
  p.time_ns = static_cast<std::int64_t>(number);
  p.revolution = ~static_cast<std::uint32_t>(number);
  p.range_mm = static_cast<float>(number % 4096U);
  return p;
}

/// Writes and reads in steps of many lengths from point `first` on, and compares each point with
/// its number.
template <class Ring>
void test_accounts(std::uint64_t first) {
  Ring ring(first);
  auto reader = ring.make_reader();
  std::uint64_t written = first;
  std::uint64_t place = first;
  std::uint64_t missed = 0;
  bool right = true;
  bool balanced = true;
  for (std::size_t step = 0; step < 400; ++step) {
    const std::size_t to_write = step * 7 % 41;  // sometimes more than the ring holds
    for (std::size_t i = 0; i < to_write; ++i) room[i] = numbered(written + i);
    ring.push(std::span<const point>(room).first(to_write));
    written += to_write;
    const ring_read got = reader.read(std::span<point>(room).first(step * 5 % 37));
    missed += got.missed;
    place += got.missed;
    for (std::size_t i = 0; i < got.points; ++i) right &= room[i] == numbered(place + i);
    place += got.points;
    balanced &= place + reader.ahead() == written && ring.written() == written;
  }
  check(right);
  check(balanced);
  check(missed > 0 && missed < written - first);
  check(written - first > 4000);
}

void test_exact_misses() {
  point_ring<16, std::uint32_t> ring(carry - 20);
  auto reader = ring.make_reader();
  for (std::uint64_t i = 0; i < 40; ++i) ring.push(numbered(carry - 20 + i));
  const ring_read got = reader.read(room);
  check(got.missed == 24);
  check(got.points == 16);
  check(room[0] == numbered(carry + 4));
  check(room[15] == numbered(carry + 19));
  const ring_read nothing = reader.read(room);
  check(nothing.points == 0 && nothing.missed == 0);
}

}  // namespace

void test_ring() {
  using narrow = point_ring<32, std::uint32_t>;
  using usual = point_ring<32>;
  for (const std::uint64_t first :
       {std::uint64_t{0}, carry - 1, carry - 100, 3 * carry - 2000, std::uint64_t{0} - 1000}) {
    test_accounts<narrow>(unknown(first));
    test_accounts<usual>(unknown(first));
  }
  test_published_count();
  test_exact_misses();
}

}  // namespace self_test
