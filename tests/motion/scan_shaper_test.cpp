// SPDX-License-Identifier: MIT
// A scan_shaper: what it leaves out, moves, flags and counts, and when.
#include "g4lidar/scan_shaper.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "driven_lidar.hpp"
#include "g4lidar/cartesian.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/grid.hpp"
#include "support/allocation_count.hpp"
#include "support/moving_lidar.hpp"

namespace g4lidar::test {
namespace {

using ::testing::ElementsAre;
using ::testing::FloatNear;

constexpr std::int64_t tenth_ns = 100'000'000;

scan scan_of(std::span<const point> points) {
  scan made;
  made.points = points;
  return made;
}

std::vector<float> ranges_of(std::span<const point> points) {
  std::vector<float> all;
  for (const point& p : points) all.push_back(p.range_mm);
  return all;
}

std::size_t flagged(std::span<const point> points) {
  return static_cast<std::size_t>(std::ranges::count_if(points, &point::is_not_deskewed));
}

/// A lidar that drives along x with 1 m/s, towards a wall that is 5 m away at the first point.
class ScanShaper : public ::testing::Test {
 protected:
  const std::array<point, 3> points_{at(180.0F, 5000.0F, begin_ns),
                                     at(180.0F, 4900.0F, begin_ns + tenth_ns),
                                     at(90.0F, 0.0F, begin_ns + 2 * tenth_ns)};
  const std::array<stamped_pose, 2> path_{
      {{begin_ns - tenth_ns, {2.0, 1.0, 0.0}}, {begin_ns + 3 * tenth_ns, {2.4, 1.0, 0.0}}}};
};

// An X4 looks at its 0 degrees. On the same path it sees the wall there, and its 270 degrees are to the left.
TEST_F(ScanShaper, AScan_IsTurnedAsItsModel) {
  std::array<point, 3> points{at(0.0F, 5000.0F, begin_ns), at(0.0F, 4900.0F, begin_ns + tenth_ns),
                              at(270.0F, 1000.0F, begin_ns + 2 * tenth_ns)};
  scan seen = scan_of(points);
  seen.model = model_named("x4");
  scan_shaper by_path({.deskew = deskewing::by_path});
  by_path.shape(seen, path_);
  const scan kept = by_path.kept();
  EXPECT_EQ(kept.model, seen.model);
  EXPECT_THAT(ranges_of(kept), ElementsAre(FloatNear(5000.0F, 0.02F), FloatNear(5000.0F, 0.02F),
                                           FloatNear(std::hypot(1000.0F, 200.0F), 0.02F)));
  std::array<xy_point, 3> places{};
  to_xy(kept, frame::robot, places);
  EXPECT_NEAR(places[2].x_m, 0.2F, 1e-4F);
  EXPECT_NEAR(places[2].y_m, 1.0F, 1e-4F);

  const std::array<corner, 3> outline{{{-0.1F, 0.9F}, {0.1F, 0.9F}, {0.0F, 1.2F}}};
  const std::array<polygon, 1> on_the_left{{polygon(outline)}};
  scan_shaper masked({.filter = {.masks = on_the_left}});
  masked.shape(seen);
  EXPECT_THAT(ranges_of(masked.kept()), ElementsAre(5000.0F, 4900.0F));
  scan_shaper ahead({.filter = {.in = frame::robot, .field_of_view = {-45.0, 45.0}}});
  ahead.shape(seen);
  EXPECT_THAT(ranges_of(ahead.kept()), ElementsAre(5000.0F, 4900.0F));
  seen.model = &g4_model;
  ahead.shape(seen);
  EXPECT_TRUE(ahead.kept().empty());
}

TEST_F(ScanShaper, ByScans_FindsTheTwistOfALidarThatIsNotTurned) {
  const twist_2d twist{0.6, 0.2, 0.5};
  driven_lidar lidar(office(), {.twist = twist, .turn_deg = 0.0}, 5);
  scan_shaper shaper({.deskew = deskewing::by_scans});
  double error_mm = 0.0;
  double as_measured_mm = 0.0;
  std::size_t count = 0;
  for (int i = 0; i < 3; ++i) {
    const std::vector<point> points = lidar.revolution();
    scan seen = scan_of(points);
    seen.model = model_named("x4");
    shaper.shape(seen);
    if (i == 0) continue;
    ASSERT_TRUE(shaper.twist());
    EXPECT_NEAR(shaper.twist()->x_m_per_s, twist.x_m_per_s, 0.03);
    EXPECT_NEAR(shaper.twist()->y_m_per_s, twist.y_m_per_s, 0.03);
    EXPECT_NEAR(shaper.twist()->yaw_rad_per_s, twist.yaw_rad_per_s, 0.01);
    const pose_2d first = lidar.pose_at(points.front().time_ns);
    const scan kept = shaper.kept();
    for (std::size_t k = 0; k < kept.size(); ++k) {
      const place truth = lidar.truth()[k];
      if (std::isnan(truth.x)) continue;
      const auto off_mm = [&](const point& p) {
        const place in_world = moved(first, own_place(p, 0.0));
        return 1000.0 * std::hypot(in_world.x - truth.x, in_world.y - truth.y);
      };
      error_mm += off_mm(kept[k]);
      as_measured_mm += off_mm(points[k]);
      ++count;
    }
  }
  EXPECT_GT(as_measured_mm / static_cast<double>(count), 50.0);
  EXPECT_LT(error_mm, 0.25 * as_measured_mm);
}

TEST_F(ScanShaper, ByDefault_GivesThePointsThatItGot) {
  scan_shaper shaper;
  EXPECT_TRUE(shaper.kept().empty());
  shaper.shape(scan_of(points_), path_);
  EXPECT_EQ(shaper.kept().data(), points_.data());
  EXPECT_EQ(shaper.for_grid().data(), points_.data());
  EXPECT_EQ(shaper.kept().size(), points_.size());
  EXPECT_FALSE(shaper.twist());
  EXPECT_EQ(shaper.outside(), 0U);
}

TEST_F(ScanShaper, MakesEachProductOnce) {
  scan_shaper shaper({.filter = {.least_range_mm = 4950.0F}});
  std::array<point, 3> own = points_;
  shaper.shape(scan_of(own));
  const std::span<const point> kept = shaper.kept();
  EXPECT_THAT(ranges_of(kept), ElementsAre(5000.0F));
  own.fill({});  // who took nothing yet gets what is there now
  EXPECT_EQ(shaper.kept().data(), kept.data());
  EXPECT_THAT(ranges_of(shaper.kept()), ElementsAre(5000.0F));
  EXPECT_THAT(ranges_of(shaper.for_grid()), ElementsAre(0.0F, 0.0F, 0.0F));
}

TEST_F(ScanShaper, ForAGrid_WhatIsLeftOutIsNotKnown) {
  scan_shaper shaper({.filter = {.least_range_mm = 4950.0F, .returns_only = true}});
  shaper.shape(scan_of(points_));
  ASSERT_EQ(shaper.for_grid().size(), 3U);
  EXPECT_EQ(shaper.for_grid()[1].flags, point_flags::too_near);
  EXPECT_EQ(shaper.for_grid()[2].flags, point_flags::no_return);
}

TEST_F(ScanShaper, CopiesWhatTheFilterViews) {
  std::vector<sector> ignored{sector(80.0, 100.0)};
  std::vector<corner> around{{4.8F, -0.1F}, {4.95F, -0.1F}, {4.95F, 0.1F}, {4.8F, 0.1F}};
  std::vector<polygon> masks{around};
  scan_shaper shaper({.filter = {.ignored_sectors = ignored, .masks = masks}});
  ignored[0] = sector(170.0, 190.0);
  std::ranges::fill(around, corner{});
  masks.clear();
  scan_shaper moved = std::move(shaper);
  moved.shape(scan_of(points_));
  EXPECT_THAT(ranges_of(moved.kept()), ElementsAre(5000.0F));
}

TEST_F(ScanShaper, ByPath_SeesTheWallFromTheFirstPlace) {
  scan_shaper shaper({.deskew = deskewing::by_path});
  shaper.shape(scan_of(points_), path_);
  const auto wall = FloatNear(5000.0F, 0.02F);
  EXPECT_THAT(ranges_of(shaper.kept()), ElementsAre(wall, wall, 0.0F));
  EXPECT_THAT(ranges_of(shaper.for_grid()), ElementsAre(wall, wall, 0.0F));
  EXPECT_EQ(shaper.kept()[1].time_ns, begin_ns + tenth_ns);
  EXPECT_EQ(shaper.points_not_deskewed(), 0U);
}

TEST_F(ScanShaper, PointsOffThePath_AreFlaggedAndCountedAndKeepTheirTime) {
  const std::array<stamped_pose, 2> first_half{path_[0], {begin_ns + tenth_ns, {2.2, 1.0, 0.0}}};
  scan_shaper shaper({.deskew = deskewing::by_path, .restamps = true});
  shaper.shape(scan_of(points_), first_half);
  EXPECT_EQ(shaper.outside(), 1U);
  ASSERT_EQ(shaper.kept().size(), 3U);
  EXPECT_EQ(shaper.kept()[1].time_ns, begin_ns);
  EXPECT_EQ(shaper.kept()[1].flags, point_flags::none);
  EXPECT_EQ(shaper.kept()[2].time_ns, begin_ns + 2 * tenth_ns);
  EXPECT_EQ(shaper.kept()[2].flags, point_flags::no_return | point_flags::not_deskewed);
  shaper.shape(scan_of(points_));
  EXPECT_EQ(shaper.outside(), 3U) << "there is no path";
  EXPECT_EQ(flagged(shaper.for_grid()), 3U);
  EXPECT_EQ(shaper.points_not_deskewed(), 4U);
}

TEST_F(ScanShaper, CountsThePointsThatItFlags) {
  std::mt19937 source(1);
  scan_shaper shaper({.deskew = deskewing::by_path});
  for (int i = 0; i < 200; ++i) {
    std::vector<point> points = some_points(source, 50, 0.1);
    for (point& p : points) p.time_ns = source() % 20 == 0 ? 0 : p.time_ns;
    const auto time = [&] {
      return begin_ns + static_cast<std::int64_t>(source() % 100) * tenth_ns - tenth_ns;
    };
    std::array<stamped_pose, 3> path{{{time(), {}}, {time(), {}}, {time(), {}}}};
    std::ranges::sort(path, {}, &stamped_pose::time_ns);
    shaper.shape(scan_of(points), std::span(path).first(source() % 4));
    EXPECT_EQ(shaper.outside(), flagged(shaper.kept())) << i;
  }
}

TEST_F(ScanShaper, ByScans_WithoutAnEarlierOne_NothingMovesAndAllIsFlagged) {
  scan_shaper shaper({.deskew = deskewing::by_scans});
  shaper.shape(scan_of(points_), path_);
  EXPECT_FALSE(shaper.twist());
  EXPECT_THAT(ranges_of(shaper.kept()), ElementsAre(5000.0F, 4900.0F, 0.0F));
  EXPECT_EQ(flagged(shaper.kept()), 3U);
  EXPECT_EQ(shaper.outside(), 3U);
}

TEST_F(ScanShaper, ByScans_MovesByTheEstimateWithoutTheFilter) {
  const drive how{.twist = {0.3, 0.0, 0.4}};
  driven_lidar lidar(office(), how, 1);
  scan_shaper shaper(
      {.filter = {.field_of_view = sector(0.0, 10.0)}, .deskew = deskewing::by_scans});
  scan_shaper merging({.deskew = deskewing::by_scans, .for_merging = true});
  for (int i = 0; i < 3; ++i) {
    const std::vector<point> points = lidar.revolution();
    shaper.shape(scan_of(points));
    merging.shape(scan_of(points));
    EXPECT_EQ(shaper.twist().has_value(), i > 0);
    EXPECT_EQ(merging.twist(), shaper.twist());
    EXPECT_EQ(merging.kept().data(), points.data()) << "merge_scans() moves them";
    EXPECT_EQ(merging.outside(), 0U);
    EXPECT_EQ(shaper.outside(), i > 0 ? 0U : points.size());
  }
  ASSERT_TRUE(shaper.twist());
  EXPECT_NEAR(shaper.twist()->x_m_per_s, 0.3, 0.05);
  EXPECT_NEAR(shaper.twist()->yaw_rad_per_s, 0.4, 0.05);
}

TEST_F(ScanShaper, OfAPiece_TheEndsAreNotNeighbours) {
  const std::array<point, 3> points{at(10.0F, 2000.0F, 1), at(180.0F, 4000.0F, 2),
                                    at(9.9F, 2000.0F, 3)};
  scan_shaper shaper({.marks = {.speckle = speckle_limits{.window = 1}}});
  scan given = scan_of(points);
  shaper.shape(given);
  EXPECT_EQ(shaper.kept().size(), 2U);
  given.flags = scan_flags::end_missing;
  shaper.shape(given);
  EXPECT_TRUE(shaper.kept().empty());
}

TEST_F(ScanShaper, WhatWasNearBefore_IsKnownAlthoughNobodyTookIt) {
  point near = at(100.0F, 400.0F, 1);
  near.revolution = 0;
  // Without return, the same beam has a direction 3.1 degrees less.
  point nothing = at(96.9F, 0.0F, 2);
  nothing.revolution = 1;
  shaping_options options{.marks = {.near = near_limits{}}};
  scan_shaper shaper(options);
  shaper.shape(scan_of({&near, 1}));
  options.filter.greatest_range_mm = 9000.0F;
  shaper.set_options(options);
  shaper.shape(scan_of({&nothing, 1}));
  ASSERT_EQ(shaper.kept().size(), 1U);
  EXPECT_TRUE(shaper.kept()[0].may_be_too_near());
  options.marks.near.reset();
  shaper.set_options(options);
  options.marks.near = near_limits{};
  shaper.set_options(options);
  shaper.shape(scan_of({&nothing, 1}));
  EXPECT_FALSE(shaper.kept()[0].may_be_too_near());
}

// A G4 at 4 kHz has returns from 100 mm on: what is at 400 mm is not near.
TEST_F(ScanShaper, WhatIsNear_FollowsTheSampleRateOfTheScan) {
  for (const std::uint32_t rate_hz : {9000U, 4000U}) {
    scan_shaper shaper({.marks = {.near = near_limits{}}});
    point near = at(100.0F, 400.0F, 1);
    near.revolution = 0;
    point nothing = at(96.9F, 0.0F, 2);
    nothing.revolution = 1;
    for (point* each : {&near, &nothing}) {
      scan given = scan_of({each, 1});
      given.sample_rate_hz = rate_hz;
      shaper.shape(given);
    }
    ASSERT_EQ(shaper.kept().size(), 1U);
    EXPECT_EQ(shaper.kept()[0].may_be_too_near(), rate_hz == 9000) << rate_hz;
  }
}

TEST_F(ScanShaper, AllocatesForTheFirstScansOnly) {
  driven_lidar lidar(office(), {.twist = {0.3, 0.0, 0.4}}, 1);
  scan_shaper shaper(
      {.filter = {.least_range_mm = 100.0F},
       .marks = {.speckle = speckle_limits{}, .edges = edge_limits{}, .near = near_limits{}},
       .deskew = deskewing::by_scans,
       .restamps = true});
  const std::vector<point> first = lidar.revolution();
  shaper.shape(scan_of(first));
  EXPECT_FALSE(shaper.kept().empty());
  EXPECT_FALSE(shaper.for_grid().empty());
  for (int i = 0; i < 3; ++i) {
    std::vector<point> points = lidar.revolution();
    points.resize(std::min(points.size(), first.size()));
    std::size_t kept = 0;
    EXPECT_EQ(test::allocations_in([&] {
                shaper.shape(scan_of(points));
                kept = shaper.kept().size() + shaper.for_grid().size();
              }),
              0U);
    EXPECT_GT(kept, points.size());
  }
}

}  // namespace
}  // namespace g4lidar::test
