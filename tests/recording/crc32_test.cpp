// SPDX-License-Identifier: MIT
#include "recording/mcap/crc32.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>

namespace g4lidar::mcap {
namespace {

constexpr std::array<std::uint8_t, 9> digits{'1', '2', '3', '4', '5', '6', '7', '8', '9'};

TEST(Crc32, OfTheStandardCheckValue) {
  EXPECT_EQ(crc32_of(digits), 0xCBF43926U);
  EXPECT_EQ(crc32_of({}), 0U);
}

TEST(Crc32, Pieces_AgreeWithTheWhole_WithEmptyOnesBetweenThem) {
  for (std::size_t first = 0; first <= digits.size(); ++first) {
    crc32 sum;
    sum.add(bytes(digits).first(first));
    sum.add({});
    sum.add(bytes(digits).subspan(first));
    sum.add({});
    EXPECT_EQ(sum.value(), 0xCBF43926U) << first;
  }
}

}  // namespace
}  // namespace g4lidar::mcap
