// SPDX-License-Identifier: MIT
#include "recording/mcap/crc32.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

namespace g4lidar::mcap {
namespace {

/// The definition: bit by bit.
std::uint32_t defined_crc32_of(bytes data) {
  std::uint32_t sum = 0xFFFFFFFFU;
  for (const std::uint8_t byte : data) {
    sum ^= byte;
    for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1U) ^ ((sum & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~sum;
}

std::vector<std::uint8_t> noise(std::size_t size) {
  std::vector<std::uint8_t> data(size);
  std::uint32_t state = 1;
  for (std::uint8_t& byte : data) {
    state = state * 1'664'525U + 1'013'904'223U;
    byte = static_cast<std::uint8_t>(state >> 24U);
  }
  return data;
}

TEST(Crc32, OfTheStandardCheckValues) {
  constexpr std::array<std::uint8_t, 9> digits{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  static_assert(crc32_of(digits) == 0xCBF43926U);
  static_assert(crc32_of({}) == 0);
  EXPECT_EQ(crc32_of(digits), 0xCBF43926U);
}

TEST(Crc32, EachLengthAtEachOffset_AgreesWithTheDefinition) {
  constexpr std::size_t most = 67;
  const std::vector<std::uint8_t> data = noise(most + 32);
  for (std::size_t from = 0; from <= 16; ++from) {
    for (std::size_t size = 0; size <= most; ++size) {
      const bytes part = bytes(data).subspan(from, size);
      ASSERT_EQ(crc32_of(part), defined_crc32_of(part)) << size << " bytes from " << from;
    }
  }
}

TEST(Crc32, Pieces_AgreeWithTheWhole) {
  const std::vector<std::uint8_t> data = noise(1'000);
  const std::uint32_t whole = defined_crc32_of(data);
  for (std::size_t piece = 1; piece <= 70; ++piece) {
    crc32 sum;
    for (bytes rest = data; !rest.empty();) {
      const bytes part = rest.first(std::min(piece, rest.size()));
      sum.add(part);
      rest = rest.subspan(part.size());
    }
    ASSERT_EQ(sum.value(), whole) << "in pieces of " << piece;
  }
}

TEST(Crc32, RunsOfOneByte_AgreeWithTheDefinition) {
  for (const std::uint8_t byte : std::initializer_list<std::uint8_t>{0x00, 0x01, 0x80, 0xFF}) {
    const std::vector<std::uint8_t> data(1'025, byte);
    EXPECT_EQ(crc32_of(data), defined_crc32_of(data)) << int{byte};
  }
}

}  // namespace
}  // namespace g4lidar::mcap
