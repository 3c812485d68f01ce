// SPDX-License-Identifier: MIT
// The ring of the microcontroller's example: a thread takes the role of the interrupt. Also run
// with the thread sanitizer.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <thread>
#include <vector>

#include "microcontroller/byte_ring.hpp"
#include "support/test_scale.hpp"

namespace {

std::vector<std::uint8_t> all_of(std::span<const std::uint8_t> bytes) {
  return {bytes.begin(), bytes.end()};
}

TEST(ByteRing, ReturnsBytesInOrder) {
  byte_ring<8> ring;
  std::array<std::uint8_t, 5> out;
  EXPECT_TRUE(ring.take(out).empty());
  std::uint8_t next = 0;
  for (int round = 0; round < 100; ++round) {
    std::vector<std::uint8_t> expected;
    for (int i = 0; i < 5; ++i) {
      expected.push_back(next);
      ring.push(next++);
    }
    EXPECT_EQ(all_of(ring.take(out)), expected);
  }
  EXPECT_EQ(ring.overruns(), 0U);
}

TEST(ByteRing, BytesWithoutRoom_AreCounted) {
  byte_ring<4> ring;
  for (std::uint8_t byte = 1; byte <= 7; ++byte) ring.push(byte);
  EXPECT_EQ(ring.overruns(), 3U);
  std::array<std::uint8_t, 3> out;
  EXPECT_EQ(all_of(ring.take(out)), (std::vector<std::uint8_t>{1, 2, 3}));
  ring.push(8);
  EXPECT_EQ(all_of(ring.take(out)), (std::vector<std::uint8_t>{4, 8}));
  EXPECT_TRUE(ring.take(out).empty());
  EXPECT_EQ(ring.overruns(), 3U);
}

TEST(ByteRing, BetweenTwoThreads_NoByteIsLostOrRepeated) {
  const auto count = static_cast<std::uint32_t>(g4lidar::test::scaled(20'000));
  byte_ring<64> ring;
  std::atomic<bool> is_done{false};
  std::uint32_t pushed = 0;  // that had room
  std::thread producer([&] {
    for (std::uint32_t tried = 0; tried < count; ++tried) {
      const std::uint32_t lost = ring.overruns();
      ring.push(static_cast<std::uint8_t>(pushed));  // the next number is that of the next position
      if (ring.overruns() == lost) {
        ++pushed;
      } else {
        std::this_thread::yield();
      }
    }
    is_done = true;
  });
  std::uint32_t taken = 0;
  std::uint32_t wrong = 0;
  const auto take_all = [&] {
    std::array<std::uint8_t, 17> out;
    for (const std::uint8_t byte : ring.take(out)) {
      wrong += byte == static_cast<std::uint8_t>(taken) ? 0U : 1U;
      ++taken;
    }
  };
  while (!is_done) take_all();
  producer.join();
  for (int i = 0; i < 4; ++i) take_all();
  EXPECT_EQ(wrong, 0U);
  EXPECT_EQ(taken, pushed);
  EXPECT_EQ(pushed + ring.overruns(), count);
}

}  // namespace
