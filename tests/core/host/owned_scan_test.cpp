// SPDX-License-Identifier: MIT
// An owned scan: it has all data of the view, and its points outlive the assembler's storage.
#include "g4lidar/lidar.hpp"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <ranges>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "g4lidar/grid.hpp"

namespace g4lidar {
namespace {

scan scan_of(std::span<const point> points) {
  scan made;
  made.points = points;
  made.revolution = 7;
  made.flags = scan_flags::data_lost;
  made.turned_deg = 359.5F;
  made.duration_ns = 143;
  return made;
}

TEST(OwnedScan, CopiesTheScanAndItsPoints) {
  std::vector<point> storage(3);
  storage[0].time_ns = 1'000;
  storage[2].range_mm = 500.0F;
  const owned_scan kept(scan_of(storage));
  const std::vector<point> before = storage;
  storage.assign(3, point{});
  const scan seen = kept;
  EXPECT_EQ(seen.revolution, 7U);
  EXPECT_EQ(seen.flags, scan_flags::data_lost);
  EXPECT_EQ(seen.turned_deg, 359.5F);
  EXPECT_EQ(seen.end_ns(), 1'143);
  EXPECT_EQ(seen.time().time_since_epoch(), std::chrono::nanoseconds(1'000));
  EXPECT_EQ(seen.end_time().time_since_epoch(), std::chrono::nanoseconds(1'143));
  EXPECT_EQ(std::vector<point>(seen.begin(), seen.end()), before);
  EXPECT_EQ(seen.data(), kept.points().data());
}

TEST(OwnedScan, CopiesAndMovesItsPoints) {
  std::vector<point> storage(2);
  owned_scan first(scan_of(storage));
  const owned_scan second = first;
  EXPECT_NE(second.view().data(), first.view().data());
  const point* const place = first.view().data();
  const owned_scan third = std::move(first);
  EXPECT_EQ(third.view().data(), place);
  EXPECT_EQ(third.view().size(), 2U);
}

TEST(OwnedScan, ReusesItsMemory) {
  std::vector<point> storage(100);
  owned_scan kept(scan_of(storage));
  const point* const place = kept.view().data();
  kept = scan_of(std::span(storage).first(40));
  EXPECT_EQ(kept.view().data(), place);
  EXPECT_EQ(kept.view().size(), 40U);
  EXPECT_EQ(std::move(kept).points().size(), 40U);
}

TEST(OwnedScan, ConvertsToAScan) {
  std::vector<point> storage(1);
  storage[0].range_mm = 2000.0F;
  const owned_scan kept(scan_of(storage));
  std::array<float, 4> ranges_m{};
  fill_grid(kept.view(), ranges_m, {frame::vendor, grid_pick::nearest, false});
  EXPECT_EQ(ranges_m[0], 2.0F);
  static_assert(!std::is_convertible_v<owned_scan, scan>, "a view of a temporary object");
  static_assert(std::is_convertible_v<const owned_scan&, scan>);
  static_assert(std::ranges::borrowed_range<scan>);
}

}  // namespace
}  // namespace g4lidar
