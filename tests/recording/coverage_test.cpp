// SPDX-License-Identifier: MIT
#include "recording/mcap/coverage.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>

namespace g4lidar {
namespace {

TEST(Coverage, LostFirstChunkOfANewFile_LeavesNothingOfTheOldFile) {
  constexpr std::array<std::uint8_t, 1> old{1};
  constexpr std::array<std::uint8_t, 1> lost{2};
  constexpr std::array<std::uint8_t, 1> kept{3};
  constexpr auto way = direction::from_device;
  coverage covered;
  covered.begin_chunk(0, true);
  covered.add(way, old);
  covered.keep_chunk();
  covered.begin_chunk(10, false);
  covered.add(way, lost);
  payload_digest open;
  open.add(way, lost);
  covered.begin_file(open);
  EXPECT_EQ(covered.lose_chunk(), 1U);
  covered.begin_chunk(20, true);
  covered.add(way, kept);
  covered.keep_chunk();
  payload_digest wanted;
  wanted.add(way, kept);
  EXPECT_EQ(covered.payload().value(), wanted.value());
}

}  // namespace
}  // namespace g4lidar
