// SPDX-License-Identifier: MIT
// Which points a filter keeps: boundaries, sectors through 0 degrees, both frames, in place.
#include "g4lidar/filter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "g4lidar/grid.hpp"

namespace g4lidar::test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

point at(float angle_deg, float range_mm = 1000.0F) {
  point p;
  p.angle_deg = angle_deg;
  p.range_mm = range_mm;
  if (range_mm == 0.0F) p.flags = point_flags::no_return;
  if (range_mm > 0.0F && range_mm < 100.0F) p.flags = point_flags::too_near;
  return p;
}

std::vector<float> angles_kept(const std::vector<float>& angles, const point_filter& filter) {
  std::vector<float> kept;
  for (const float degrees : angles) {
    if (filter.keeps(at(degrees))) kept.push_back(degrees);
  }
  return kept;
}

TEST(Sector, ContainsBothEnds) {
  constexpr sector ahead(10.0, 20.0);
  static_assert(ahead.has(10.0) && ahead.has(15.0) && ahead.has(20.0));
  static_assert(!ahead.is_everything());
  EXPECT_FALSE(ahead.has(std::nextafter(10.0, 0.0)));
  EXPECT_FALSE(ahead.has(std::nextafter(20.0, 90.0)));
}

TEST(Sector, ContainsZero) {
  for (const sector& cable : {sector(350.0, 10.0), sector(-10.0, 10.0), sector(350.0, 370.0),
                              sector(-370.0, -350.0), sector(710.0, 10.0)}) {
    for (const double degrees : {350.0, 359.999, 0.0, 5.0, 10.0}) {
      EXPECT_TRUE(cable.has(degrees)) << degrees;
    }
    for (const double degrees : {349.999, 10.001, 180.0}) EXPECT_FALSE(cable.has(degrees));
  }
}

TEST(Sector, SwappedEnds_AreTheComplement) {
  const sector rest(10.0, 350.0);
  EXPECT_TRUE(rest.has(10.0));
  EXPECT_TRUE(rest.has(180.0));
  EXPECT_TRUE(rest.has(350.0));
  EXPECT_FALSE(rest.has(0.0));
  EXPECT_FALSE(rest.has(355.0));
}

TEST(Sector, UpToZeroAndFromZero) {
  const sector up_to(350.0, 360.0);  // 360 is 0
  EXPECT_TRUE(up_to.has(0.0));
  EXPECT_TRUE(up_to.has(355.0));
  EXPECT_FALSE(up_to.has(0.001));
  const sector from(0.0, 10.0);
  EXPECT_TRUE(from.has(0.0));
  EXPECT_FALSE(from.has(359.999));
}

TEST(Sector, FullTurn_IsEverything_NoTurn_IsOneDirection) {
  EXPECT_TRUE(sector().is_everything());
  EXPECT_TRUE(sector(0.0, 360.0).is_everything());
  EXPECT_TRUE(sector(-180.0, 180.0).is_everything());
  EXPECT_TRUE(sector(-360.0, 360.0).is_everything());
  EXPECT_FALSE(sector(0.0, 359.999).is_everything());
  const sector one(45.0, 45.0);
  EXPECT_TRUE(one.has(45.0));
  EXPECT_FALSE(one.has(45.001));
  EXPECT_FALSE(one.has(44.999));
}

// The robot's bearing is 180 degrees minus the device's angle: straight ahead is 180, left is 90.
TEST(PointFilter, Sectors_AreInTheGivenFrame) {
  point_filter ahead;
  ahead.in = frame::robot;
  ahead.field_of_view = {-90.0, 90.0};
  EXPECT_THAT(angles_kept({0, 89, 90, 180, 270, 271, 359}, ahead), ElementsAre(90, 180, 270));
  point_filter behind = ahead;
  behind.field_of_view = {90.0, -90.0};
  EXPECT_THAT(angles_kept({0, 89, 90, 180, 270, 271, 359}, behind),
              ElementsAre(0, 89, 90, 270, 271, 359));
  point_filter device = ahead;
  device.in = frame::vendor;
  EXPECT_THAT(angles_kept({0, 89, 90, 180, 270, 271, 359}, device),
              ElementsAre(0, 89, 90, 270, 271, 359));
}

TEST(PointFilter, AnyNumberOfIgnoredSectors) {
  std::vector<sector> posts;
  for (int i = 0; i < 36; ++i) posts.emplace_back(i * 10.0, i * 10.0 + 8.0);
  point_filter filter;
  filter.ignored_sectors = posts;
  std::vector<float> expected;
  std::vector<float> all;
  for (int degrees = 0; degrees < 360; ++degrees) {
    all.push_back(static_cast<float>(degrees));
    if (degrees % 10 == 9) expected.push_back(static_cast<float>(degrees));
  }
  EXPECT_EQ(angles_kept(all, filter), expected);
  filter.field_of_view = {300.0, 20.0};
  EXPECT_THAT(angles_kept(all, filter), ElementsAre(9, 19, 309, 319, 329, 339, 349, 359));
}

TEST(PointFilter, Ranges_IncludeBothLimits) {
  point_filter filter;
  filter.least_range_mm = 280.0F;
  filter.greatest_range_mm = 16'000.0F;
  EXPECT_TRUE(filter.keeps(at(0, 280.0F)));
  EXPECT_TRUE(filter.keeps(at(0, 16'000.0F)));
  EXPECT_FALSE(filter.keeps(at(0, 279.75F)));
  EXPECT_FALSE(filter.keeps(at(0, 16'000.25F)));
  EXPECT_FALSE(filter.keeps(at(0, 0.0F))) << "a point without return has range 0";
  filter.least_range_mm = 0.0F;
  EXPECT_TRUE(filter.keeps(at(0, 0.0F)));
}

TEST(PointFilter, ReturnsOnlyAndTrustedOnly) {
  point_filter filter;
  EXPECT_TRUE(filter.keeps_everything());
  filter.returns_only = true;
  EXPECT_FALSE(filter.keeps_everything());
  EXPECT_FALSE(filter.keeps(at(0, 0.0F)));
  EXPECT_TRUE(filter.keeps(at(0, 50.0F)));
  filter = {};
  filter.trusted_only = true;
  EXPECT_TRUE(filter.keeps(at(0, 0.0F)));
  EXPECT_FALSE(filter.keeps(at(0, 50.0F)));
}

TEST(PointFilter, DropsNotANumber) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  point_filter filter;
  EXPECT_FALSE(filter.keeps(at(0, nan)));
  filter.field_of_view = {0.0, 90.0};
  EXPECT_FALSE(filter.keeps(at(nan)));
}

TEST(FilterPoints, KeepsTheOrderInPlaceAndInOtherMemory) {
  const std::array<point, 5> all{at(1), at(100), at(2), at(200), at(3)};
  point_filter filter;
  filter.field_of_view = {0.0, 90.0};
  std::array<point, 5> other{};
  EXPECT_THAT(filter_points(all, filter, other), ElementsAre(at(1), at(2), at(3)));
  std::array<point, 5> same = all;
  const auto kept = filter_points(same, filter);
  EXPECT_EQ(kept.data(), same.data());
  EXPECT_THAT(kept, ElementsAre(at(1), at(2), at(3)));
  EXPECT_THAT(filter_points(std::span<point>(), filter), IsEmpty());
}

// In the robot's frame the device's 180 degrees are ahead, and 90 degrees are to the left.
TEST(PointFilter, Masks_AreInTheRobotsFrame) {
  const std::array<corner, 4> ahead{{{0.9F, -0.1F}, {1.1F, -0.1F}, {1.1F, 0.1F}, {0.9F, 0.1F}}};
  const std::array<corner, 3> left{{{-0.2F, 0.8F}, {0.2F, 0.8F}, {0.0F, 1.5F}}};
  const std::array<polygon, 2> masks{ahead, left};
  point_filter filter;
  filter.masks = masks;
  EXPECT_FALSE(filter.keeps_everything());
  for (const frame in : {frame::vendor, frame::robot}) {
    filter.in = in;
    EXPECT_THAT(angles_kept({0, 90, 100, 180, 184, 190, 270}, filter),
                ElementsAre(0, 100, 190, 270));
    EXPECT_TRUE(filter.keeps(at(180, 1200.0F)));
    EXPECT_TRUE(filter.keeps(at(180, 800.0F)));
    EXPECT_TRUE(filter.keeps(at(180, 0.0F))) << "a point without return has no place";
  }
}

TEST(PointFilter, TurnOfALidar_DecidesWhereTheRobotsFrameIs) {
  const std::array<corner, 3> outline{{{0.5F, -0.5F}, {0.5F, 0.5F}, {2.0F, 0.0F}}};  // ahead
  const std::array<polygon, 1> masks{{polygon(outline)}};
  for (const std::uint16_t turn_deg : {std::uint16_t{0}, std::uint16_t{180}}) {
    const auto ahead_deg = static_cast<float>(turn_deg);
    const point_filter front{
        .in = frame::robot, .turn_deg = turn_deg, .field_of_view = {-10.0, 10.0}};
    EXPECT_TRUE(front.keeps(at(ahead_deg)));
    EXPECT_FALSE(front.keeps(at(180.0F - ahead_deg)));
    const point_filter masked{.turn_deg = turn_deg, .masks = masks};
    EXPECT_FALSE(masked.keeps(at(ahead_deg)));
    EXPECT_TRUE(masked.keeps(at(180.0F - ahead_deg)));
  }
  const point_filter left{.in = frame::robot, .turn_deg = 0, .field_of_view = {80.0, 100.0}};
  EXPECT_TRUE(left.keeps(at(270.0F)));
  EXPECT_FALSE(left.keeps(at(90.0F)));
}

TEST(PointFilter, Excluded_LeavesOutFlaggedPoints) {
  using enum point_flags;
  point p = at(0);
  p.flags = veiling | revolution_start;
  point_filter filter;
  EXPECT_TRUE(filter.keeps(p));
  filter.excluded = isolated;
  EXPECT_FALSE(filter.keeps_everything());
  EXPECT_TRUE(filter.keeps(p));
  filter.excluded = isolated | veiling;
  EXPECT_FALSE(filter.keeps(p));
}

// With a minimum of 1 m: a return at 0.5 m makes its bin unknown, even if another sample of the bin
// brought no return; one at 50 mm within limits that include it is used.
TEST(FilterForGrid, DistinguishesEmptyFromUnknown) {
  const std::array<point, 5> all{at(0, 500.0F), at(1, 0.0F), at(90, 2000.0F), at(180, 0.0F),
                                 at(270, 50.0F)};
  std::array<point, 5> memory{};
  std::array<float, 4> bins{};
  point_filter filter;
  filter.least_range_mm = 1000.0F;
  fill_grid(filter_for_grid(all, filter, memory), bins, {.to = frame::vendor});
  EXPECT_TRUE(std::isnan(bins[0]));
  EXPECT_EQ(bins[1], 2.0F);
  EXPECT_TRUE(std::isinf(bins[2]));
  EXPECT_TRUE(std::isnan(bins[3]));
  filter.least_range_mm = 10.0F;
  filter.ignored_sectors = {};
  filter.field_of_view = {135.0, 45.0};
  fill_grid(filter_for_grid(all, filter, memory), bins, {.to = frame::vendor});
  EXPECT_EQ(bins[0], 0.5F);
  EXPECT_TRUE(std::isnan(bins[1])) << "left out: not known, not empty";
  EXPECT_TRUE(std::isinf(bins[2]));
  EXPECT_EQ(bins[3], 0.05F);
}

// Where a return is left out, something was in the way of the beam: a sample without return in the
// same bin must not make it free.
TEST(FilterForGrid, MaskedAndFlaggedReturns_MakeABinUnknown) {
  std::array<point, 6> all{at(0), at(1, 0.0F), at(90), at(91, 0.0F), at(180), at(270)};
  all[2].flags = point_flags::isolated;
  all[4].flags = point_flags::veiling | point_flags::revolution_start;
  const std::array<corner, 4> behind{
      {{-1.1F, -0.1F}, {-0.9F, -0.1F}, {-0.9F, 0.1F}, {-1.1F, 0.1F}}};
  const std::array<polygon, 1> masks{behind};
  point_filter filter;
  filter.masks = masks;
  filter.excluded = point_flags::isolated;
  for (const float least_mm : {0.0F, 300.0F}) {
    filter.least_range_mm = least_mm;
    std::array<point, 6> memory{};
    std::array<float, 4> bins{};
    fill_grid(filter_for_grid(all, filter, memory), bins, {.to = frame::vendor});
    EXPECT_TRUE(std::isnan(bins[0]));
    EXPECT_TRUE(std::isnan(bins[1]));
    EXPECT_EQ(bins[2], 1.0F) << "its flag is not among those to leave out";
    EXPECT_EQ(bins[3], 1.0F);
    EXPECT_EQ(memory[4].flags, all[4].flags);
  }
}

}  // namespace
}  // namespace g4lidar::test
