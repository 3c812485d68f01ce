// SPDX-License-Identifier: MIT
#include "survey/return_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "g4lidar/core/model.hpp"

namespace g4lidar {
namespace {

using ::testing::IsEmpty;

/// A packet of two-byte samples, from first-level angles in degrees.
std::vector<std::uint8_t> packet(double first_deg, double last_deg,
                                 const std::vector<std::uint16_t>& samples) {
  const auto raw = [](double deg) {
    return static_cast<std::uint16_t>(
        static_cast<unsigned>(std::lround(deg * 64.0)) % 23040U << 1U | 1U);
  };
  const std::uint16_t first = raw(first_deg);
  const std::uint16_t last = raw(last_deg);
  const auto size_word = static_cast<std::uint16_t>(samples.size() << 8U);
  std::uint16_t sum = 0x55AA ^ first ^ last ^ size_word;
  for (const std::uint16_t each : samples) sum ^= each;
  std::vector<std::uint8_t> out;
  for (const std::uint16_t word : {std::uint16_t{0x55AA}, size_word, first, last, sum}) {
    out.push_back(static_cast<std::uint8_t>(word & 0xFFU));
    out.push_back(static_cast<std::uint8_t>(word >> 8U));
  }
  for (const std::uint16_t word : samples) {
    out.push_back(static_cast<std::uint8_t>(word & 0xFFU));
    out.push_back(static_cast<std::uint8_t>(word >> 8U));
  }
  return out;
}

/// Some turns of 720 samples, in packets of 40; `range_mm` of the direction in which the device looks, 0: no return.
return_map turns(int count, const model& of, const std::function<double(double)>& range_mm,
                 bool is_thinned = false) {
  return_map seen(is_thinned);
  for (int turn = 0; turn < count; ++turn) {
    for (int from = 0; from < 720; from += 40) {
      std::vector<std::uint16_t> samples;
      for (int i = 0; i < 40; ++i) {
        samples.push_back(static_cast<std::uint16_t>(range_mm((from + i) * 0.5) * 4.0));
      }
      auto all = packet(from * 0.5, (from + 39) * 0.5, samples);
      if (from == 0) {
        all[2] = 1;    // CT: a zero packet
        all[8] ^= 1U;  // its place in the checksum
      }
      const auto view = packet_view::from(bytes(all), of.samples);
      EXPECT_TRUE(view.has_value());
      if (view) seen.take(*view, of.samples);
    }
  }
  return seen;
}

std::vector<direction_arc> arcs_in(const return_map& seen, int least_deg) {
  return seen.without_return(least_deg, [](float) { return true; });
}

TEST(ReturnMap, AWallAllAroundHasNoArc) {
  const auto seen = turns(3, g4_model, [](double) { return 2000.0; });
  EXPECT_EQ(seen.samples(), 2160U);
  EXPECT_EQ(seen.returns(), 2160U);
  EXPECT_TRUE(seen.is_round());
  EXPECT_THAT(arcs_in(seen, 30), IsEmpty());
}

TEST(ReturnMap, NothingAtAllIsOneArc) {
  const auto seen = turns(3, g4_model, [](double) { return 0.0; });
  EXPECT_EQ(seen.returns(), 0U);
  const auto arcs = arcs_in(seen, 30);
  ASSERT_EQ(arcs.size(), 1U);
  EXPECT_EQ(arcs[0].width_deg, 360);
}

TEST(ReturnMap, TwoTurnsAreTooFewForAnArc) {
  const auto seen = turns(2, g4_model, [](double) { return 0.0; });
  EXPECT_TRUE(seen.is_round());
  EXPECT_THAT(arcs_in(seen, 30), IsEmpty());
}

// Far targets appear 7.99 degrees before the angle in the packet, at 2 m 7.37: so nothing comes back from 112.6 to
// 142.0 where samples of 120 to 150 have no range; counted one degree wider on both sides, and by whole degrees.
TEST(ReturnMap, AnArcIsWhereTheSensorLooks) {
  const auto seen =
      turns(4, g4_model, [](double deg) { return deg >= 120 && deg < 160 ? 0.0 : 2000.0; });
  const auto arcs = arcs_in(seen, 30);
  ASSERT_EQ(arcs.size(), 1U);
  EXPECT_NEAR(arcs[0].from_deg, 114.5, 1.5);
  EXPECT_NEAR(arcs[0].from_deg + arcs[0].width_deg, 150.5, 1.5);
}

TEST(ReturnMap, AnArcMayPassZero) {
  const auto seen =
      turns(4, g4_model, [](double deg) { return deg < 30 || deg >= 340 ? 0.0 : 2000.0; });
  const auto arcs = arcs_in(seen, 30);
  ASSERT_EQ(arcs.size(), 1U);
  EXPECT_NEAR(arcs[0].from_deg, 334.5, 1.5);
  EXPECT_NEAR(arcs[0].from_deg + arcs[0].width_deg, 360 + 20.5, 1.5);
}

// At 155.3 mm the correction is 0: a near target is elsewhere than where the sensor looks.
TEST(ReturnMap, ANearReturnIsAtItsOwnAngle) {
  const auto seen = turns(4, g4_model, [](double deg) {
    if (deg == 90.0) return 155.25;
    return deg >= 50 && deg < 130 ? 0.0 : 2000.0;
  });
  const auto arcs = arcs_in(seen, 25);
  ASSERT_EQ(arcs.size(), 2U);
  EXPECT_NEAR(arcs[0].from_deg + arcs[0].width_deg, 89, 1);
  EXPECT_NEAR(arcs[1].from_deg, 92, 1);
}

TEST(ReturnMap, TwoCanBeAdded) {
  auto all = turns(2, g4_model, [](double deg) { return deg < 100 ? 1500.0 : 0.0; });
  all.add(turns(2, g4_model, [](double deg) { return deg < 200 ? 1500.0 : 0.0; }));
  const auto arcs = arcs_in(all, 30);
  ASSERT_EQ(arcs.size(), 1U);
  EXPECT_EQ(all.samples(), 4U * 720U);
  EXPECT_NEAR(arcs[0].from_deg, 195, 2);
}

// The first revolution, and the sixty-fourth.
TEST(ReturnMap, AThinnedOneLooksNowAndThen) {
  const auto zero = packet(0, 0, {8000});
  std::vector<std::uint8_t> begin = zero;
  begin[2] = 1;    // CT: a zero packet
  begin[8] ^= 1U;  // its place in the checksum
  return_map seen(true);
  for (int turn = 0; turn < 70; ++turn) {
    const auto view = packet_view::from(bytes(begin), g4_format);
    ASSERT_TRUE(view.has_value());
    seen.take(*view, g4_format);
  }
  EXPECT_EQ(seen.samples(), 2U);
}

// As of a window: the stretch that ended, and the one that has begun.
TEST(ReturnMap, TwoThinnedOnesShowTheWholeArc) {
  const auto range_mm = [](double deg) { return deg >= 120 && deg < 240 ? 0.0 : 2000.0; };
  auto all = turns(35, g4_model, range_mm, true);
  EXPECT_THAT(arcs_in(all, 30), IsEmpty()) << "one revolution is too few";
  all.add(turns(2, g4_model, range_mm, true));
  const auto arcs = arcs_in(all, 30);
  ASSERT_EQ(arcs.size(), 1U);
  EXPECT_NEAR(arcs[0].from_deg, 114.5, 1.5);
  EXPECT_NEAR(arcs[0].from_deg + arcs[0].width_deg, 230.5, 1.5);
}

TEST(ReturnMap, DirectionsThatNobodyWantsAreNoArc) {
  const auto seen = turns(4, g4_model, [](double deg) { return deg < 180 ? 2000.0 : 0.0; });
  ASSERT_EQ(arcs_in(seen, 30).size(), 1U);
  EXPECT_THAT(seen.without_return(30, [](float deg) { return deg < 200 || deg > 335; }), IsEmpty());
  const auto half = seen.without_return(30, [](float deg) { return deg < 250; });
  ASSERT_EQ(half.size(), 1U);
  EXPECT_EQ(half[0].from_deg + half[0].width_deg, 250);
}

}  // namespace
}  // namespace g4lidar
