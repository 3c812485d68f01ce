// SPDX-License-Identifier: MIT
// The times and flags of merged points: those of points whose motion is not known are their own.
#include "service/scan_merger.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "g4lidar/scan_shaper.hpp"

namespace g4lidar::test {
namespace {

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t begin_ns = 5'000 * ms;
constexpr std::int64_t turn_ns = 100 * ms;
constexpr std::int64_t reference_ns = begin_ns + turn_ns;
constexpr int count = 100;

std::vector<point> revolution() {
  std::vector<point> made;
  for (int i = 0; i < count; ++i) {
    point p{};
    p.range_mm = 2000.0F;
    p.angle_deg = 3.6F * static_cast<float>(i);
    p.time_ns = begin_ns + i * ms;
    made.push_back(p);
  }
  return made;
}

class MergedTimes : public testing::Test {
 protected:
  /// One revolution of each of two lidars at the same time, where `path` is known.
  std::vector<point> merged(deskewing how, const std::vector<stamped_odometry>& path = {}) {
    scan_merger merger(how, {{"front", {}}, {"rear", {}}});
    odometry_path poses;
    for (const stamped_odometry& each : path) poses.add(each);
    const std::vector<point> points = revolution();
    scan source{};
    source.points = points;
    source.duration_ns = turn_ns;
    std::vector<point> made;
    for (const std::size_t lidar : {1U, 0U}) {
      scan_shaper shaper({.deskew = how, .for_merging = true});
      shaper.shape(source);
      const auto all = merger.add(lidar, shaper, begin_ns, turn_ns, true,
                                  [&](std::int64_t end_ns) { return poses.until(end_ns); });
      if (!all) continue;
      EXPECT_EQ(all->reference_ns, reference_ns);
      made.assign(all->kept.begin(), all->kept.end());
    }
    return made;
  }
  /// Whether the points from `first` on of each lidar, and these only, were deskewed.
  static void expect_deskewed_from(const std::vector<point>& all, int first) {
    ASSERT_EQ(all.size(), 2U * count);
    for (int i = 0; i < 2 * count; ++i) {
      const point& p = all[static_cast<std::size_t>(i)];
      const bool is_known = i % count >= first;
      EXPECT_EQ(p.is_not_deskewed(), !is_known) << i;
      EXPECT_EQ(p.time_ns, is_known ? reference_ns : begin_ns + i % count * ms) << i;
    }
  }
};

TEST_F(MergedTimes, WithoutOdometry_AreTheirOwn) {
  expect_deskewed_from(merged(deskewing::by_path), count);
}

TEST_F(MergedTimes, OfTheFirstScans_AreTheirOwn) {
  expect_deskewed_from(merged(deskewing::by_scans), count);
}

TEST_F(MergedTimes, BeforeTheOdometry_AreTheirOwn) {
  const std::vector<stamped_odometry> path{{begin_ns + 40 * ms, pose_2d{0.0, 0.0, 0.0}, {}},
                                           {reference_ns + ms, pose_2d{0.05, 0.0, 0.0}, {}}};
  expect_deskewed_from(merged(deskewing::by_path, path), 40);
}

TEST_F(MergedTimes, OnAKnownPath_AreTheReference) {
  const std::vector<stamped_odometry> path{{begin_ns - ms, pose_2d{0.0, 0.0, 0.0}, {}},
                                           {reference_ns + ms, pose_2d{0.05, 0.0, 0.0}, {}}};
  expect_deskewed_from(merged(deskewing::by_path, path), 0);
}

// Nobody wants it: no point is flagged.
TEST_F(MergedTimes, WithoutDeskewing_AreTheirOwnWithoutAFlag) {
  const std::vector<point> all = merged(deskewing::none);
  ASSERT_EQ(all.size(), 2U * count);
  for (int i = 0; i < 2 * count; ++i) {
    EXPECT_EQ(all[static_cast<std::size_t>(i)].time_ns, begin_ns + i % count * ms) << i;
    EXPECT_FALSE(all[static_cast<std::size_t>(i)].is_not_deskewed()) << i;
  }
}

}  // namespace
}  // namespace g4lidar::test
