// SPDX-License-Identifier: MIT
// Points of damaged packets that the checksum let pass, among packets that look the same.
#include "sample_matcher.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

namespace {

using namespace g4lidar;
using simulation::sample_matcher;

constexpr std::size_t samples = 40;

/// A packet of a head that stands still and sees nothing.
std::vector<sim::sent_sample> standing(std::uint64_t number, bool whole) {
  std::vector<sim::sent_sample> all(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    all[i].truth.index = (number * samples) + i;
    all[i].truth.first_level_deg = 123.0;
    all[i].packet = number;
    all[i].count = samples;
    all[i].position = static_cast<std::uint8_t>(i);
    all[i].whole = whole;
  }
  return all;
}

std::vector<point> delivered() {
  std::vector<point> all(samples);
  const double turn_rad = std::atan(-21.8 / 155.3);  // without a return
  for (point& p : all) {
    p.angle_deg = static_cast<float>(123.0 + turn_rad * 180.0 / std::numbers::pi);
  }
  return all;
}

/// A truncated packet takes in the header of the next one: of zeros alone the checksum still agrees.
TEST(SampleMatcher, ADamagedPacketDoesNotFollowItsOwnPoints) {
  sample_matcher matcher;
  for (std::uint64_t number = 0; number < 4; ++number) matcher.add(standing(number, number != 0));
  std::vector<point> garbled = delivered();
  garbled[18].range_mm = 5482.5F;  // AA 55
  matcher.add(std::span<const point>(garbled));
  for (int i = 0; i < 2; ++i) matcher.add(std::span<const point>(delivered()));
  matcher.settle(true);
  EXPECT_EQ(matcher.problem(), "");
  EXPECT_EQ(matcher.counts().blind_packets, 1U);
  EXPECT_EQ(matcher.counts().points, 2 * samples);
}

/// Behind such a packet the points of the next one, which is garbled too, are not known either. In the
/// zeros behind them a packet would fit anywhere.
TEST(SampleMatcher, TwoGarbledPacketsInARowKeepTheirLengths) {
  sample_matcher matcher;
  for (std::uint64_t number = 0; number < 9; ++number) {
    matcher.add(standing(number, number != 0 && number != 2));
  }
  for (const std::size_t header : {24U, 5U}) {
    std::vector<point> garbled = delivered();
    garbled[header].range_mm = 5482.5F;
    matcher.add(std::span<const point>(garbled));
  }
  for (int i = 0; i < 5; ++i) matcher.add(std::span<const point>(delivered()));
  matcher.settle(true);
  EXPECT_EQ(matcher.problem(), "");
  EXPECT_EQ(matcher.counts().blind_packets, 2U);
  EXPECT_EQ(matcher.counts().blind_points, 2 * samples);
  EXPECT_EQ(matcher.counts().points, 5 * samples);
}

TEST(SampleMatcher, PointsThatNoDamageExplainsWereNeverSent) {
  sample_matcher matcher;
  for (std::uint64_t number = 0; number < 4; ++number) matcher.add(standing(number, true));
  std::vector<point> garbled = delivered();
  garbled[18].range_mm = 5482.5F;
  matcher.add(std::span<const point>(garbled));
  matcher.add(std::span<const point>(delivered()));
  matcher.settle(true);
  EXPECT_NE(matcher.problem(), "");
}

}  // namespace
