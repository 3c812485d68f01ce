// SPDX-License-Identifier: MIT
// The fixed grid: the bin of a point, the choice between points, and the value of an empty bin.
#include "g4lidar/grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "g4lidar/core/decode.hpp"
#include "support/packet_maker.hpp"
#include "support/test_scale.hpp"

namespace g4lidar {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

constexpr point at(float angle_deg, float range_mm) {
  point p;
  p.angle_deg = angle_deg;
  p.range_mm = range_mm;
  if (range_mm == 0.0F) {
    p.flags = point_flags::no_return;
  } else if (range_mm < 100.0F) {
    p.flags = point_flags::too_near;
  }
  return p;
}

std::vector<float> grid_of(const std::vector<point>& points, std::size_t bins,
                           const grid_options& options = {}) {
  std::vector<float> ranges_m(bins, -77.0F);
  fill_grid(points, ranges_m, options);
  return ranges_m;
}

constexpr grid_options vendor_nearest{frame::vendor, grid_pick::nearest, false};
constexpr grid_options vendor_minimum{frame::vendor, grid_pick::minimum, false};

TEST(Grid, EveryScan_FillsEveryBin) {
  for (const std::size_t bins : {1U, 7U, 360U, 1440U, 4000U}) {
    for (const float range_m : grid_of({}, bins)) EXPECT_TRUE(std::isnan(range_m));
    const std::vector<float> one = grid_of({at(33, 1500)}, bins);
    ASSERT_EQ(one.size(), bins);
    std::size_t seen = 0;
    for (const float range_m : one) seen += std::fabs(range_m - 1.5F) < 1e-6F ? 1U : 0U;
    EXPECT_EQ(seen, 1U);
  }
}

TEST(Grid, NoReturn_BecomesWhatTheOptionSets) {
  const std::vector<point> points{at(0, 1500), at(90, 0), at(180, 50)};
  const auto range_at_90 = [&](no_return_as what) {
    const std::vector<float> ranges_m =
        grid_of(points, 4, {.to = frame::vendor, .no_return = what});
    EXPECT_FLOAT_EQ(ranges_m[0], 1.5F);
    EXPECT_TRUE(std::isnan(ranges_m[2])) << "too near is not a no-return";
    EXPECT_TRUE(std::isnan(ranges_m[3])) << "nor is a direction without samples";
    return ranges_m[1];
  };
  EXPECT_EQ(range_at_90(no_return_as::infinity), infinity);
  EXPECT_TRUE(std::isnan(range_at_90(no_return_as::nan)));
  EXPECT_EQ(range_at_90(no_return_as::max), 16.0F);
  EXPECT_EQ(grid_options{}.no_return, no_return_as::infinity);
}

// In the robot's frame bin 0 is behind; the next ones are to the right, ahead and to the left.
TEST(Grid, AScan_IsTurnedAsItsModel_WhichHasTheLongestRange) {
  const std::vector<point> points{at(0, 1000), at(90, 2000), at(180, 0), at(270, 4000)};
  std::array<float, 4> ranges_m{};
  const auto quarter_mm = [](float range_m) { return std::lround(range_m * 4000.0F); };
  const auto filled = [&](const char* name) {
    const scan seen{.points = points, .model = model_named(name)};
    fill_grid(seen, ranges_m, {.no_return = no_return_as::max});
    std::vector<long> made;
    for (const float range_m : ranges_m) made.push_back(quarter_mm(range_m));
    return made;
  };
  EXPECT_EQ(filled("x4"), (std::vector{40000L, 8000L, 4000L, 16000L}));
  EXPECT_EQ(filled("t-mini-plus-sh"), (std::vector{100000L, 8000L, 4000L, 16000L}));
  EXPECT_EQ(filled("g4"), (std::vector{4000L, 16000L, 64000L, 8000L}));
  EXPECT_EQ(filled("g6"), (std::vector{4000L, 16000L, 100000L, 8000L}));
  EXPECT_EQ(filled("tg30"), (std::vector{4000L, 16000L, 120000L, 8000L}));
  // Points that are not in a scan: by the options, and by default as those of a G4.
  EXPECT_EQ(grid_of(points, 4, {.turn_deg = 0})[2], 1.0F);
  EXPECT_EQ(grid_of(points, 4)[0], 1.0F);
  EXPECT_EQ(place_in_grid(90.0F, frame::robot, 4, 0).bin, 1U);
  EXPECT_EQ(place_in_grid(90.0F, frame::robot, 4).bin, 3U);
}

TEST(Grid, DefaultNumberOfBins_IsFourFifthsOfTheSamplesAt10Hz) {
  EXPECT_EQ(default_bins(g4_model), 720U);
  for (const auto& [name, bins] : std::vector<std::pair<const char*, std::uint32_t>>{
           {"x2", 240}, {"x4", 400}, {"t-mini-pro", 320}, {"g6", 1440}, {"tg30", 1600}}) {
    EXPECT_EQ(default_bins(*model_named(name)), bins) << name;
  }
}

TEST(Grid, ADirectionThatMayBeTooNear_IsNotFree) {
  point flagged = at(91, 0);
  flagged.flags = flagged.flags | point_flags::may_be_too_near;
  const auto range_of = [&](std::vector<point> points, const grid_options& options) {
    points.push_back(flagged);
    return grid_of(points, 4, options)[1];
  };
  const grid_options usual{.to = frame::vendor};
  const grid_options minus{.to = frame::vendor, .near_is_minus_infinity = true};
  EXPECT_TRUE(std::isnan(range_of({}, usual)));
  EXPECT_EQ(range_of({}, minus), -infinity);
  const grid_options max{.to = frame::vendor, .no_return = no_return_as::max};
  EXPECT_TRUE(std::isnan(range_of({}, max)));
  EXPECT_EQ(range_of({at(90, 0)}, minus), -infinity)
      << "it hides no-returns that are nearer to the middle";
  EXPECT_FLOAT_EQ(range_of({at(80, 1500)}, minus), 1.5F) << "and never a return,";
  EXPECT_TRUE(std::isnan(range_of({at(80, 50)}, minus))) << "even one that is not reliable";
}

TEST(Grid, RobotBins_BeginBehindAndGoCounterClockwise) {
  const auto bin_of = [](float direction) {
    return place_in_grid(direction, frame::robot, 360).bin;
  };
  EXPECT_EQ(bin_of(0), 0U);      // the cable exit: -180 degrees
  EXPECT_EQ(bin_of(270), 90U);   // right: -90 degrees
  EXPECT_EQ(bin_of(180), 180U);  // in front
  EXPECT_EQ(bin_of(90), 270U);   // left
  EXPECT_EQ(bin_of(1), 359U);
  EXPECT_EQ(bin_of(359), 1U);
}

TEST(Grid, VendorBins_BeginAtTheCableAndGoClockwise) {
  const auto bin_of = [](float direction) {
    return place_in_grid(direction, frame::vendor, 360).bin;
  };
  EXPECT_EQ(bin_of(0), 0U);
  EXPECT_EQ(bin_of(90), 90U);
  EXPECT_EQ(bin_of(180), 180U);
  EXPECT_EQ(bin_of(359), 359U);
}

TEST(Grid, Bin_ExtendsHalfItsWidthToBothSides) {
  const auto bin_of = [](float direction) {
    return place_in_grid(direction, frame::vendor, 360).bin;
  };
  EXPECT_EQ(bin_of(0.499F), 0U);
  EXPECT_EQ(bin_of(0.501F), 1U);
  EXPECT_EQ(bin_of(359.501F), 0U);
  EXPECT_EQ(bin_of(359.499F), 359U);
  EXPECT_EQ(bin_of(std::nextafter(360.0F, 0.0F)), 0U);
  EXPECT_EQ(bin_of(std::numeric_limits<float>::min()), 0U);
  EXPECT_FLOAT_EQ(place_in_grid(10.25F, frame::vendor, 360).off_middle_deg, 0.25F);
  EXPECT_FLOAT_EQ(place_in_grid(9.75F, frame::vendor, 360).off_middle_deg, 0.25F);
  EXPECT_NEAR(place_in_grid(359.75F, frame::vendor, 360).off_middle_deg, 0.25F, 1e-4F);
}

TEST(Grid, Nearest_TakesTheMiddlePoint_Minimum_TheClosest) {
  const std::vector<point> points{at(9.6F, 900), at(10.1F, 3000), at(10.4F, 500), at(10.2F, 700)};
  EXPECT_FLOAT_EQ(grid_of(points, 360, vendor_nearest)[10], 3.0F);
  EXPECT_FLOAT_EQ(grid_of(points, 360, vendor_minimum)[10], 0.5F);
  const std::vector<point> backwards(points.rbegin(), points.rend());
  EXPECT_FLOAT_EQ(grid_of(backwards, 360, vendor_nearest)[10], 3.0F);
  EXPECT_FLOAT_EQ(grid_of(backwards, 360, vendor_minimum)[10], 0.5F);
}

TEST(Grid, NoReturnNeverHidesAReturn) {
  // The point without return is exactly in the middle of bin 10.
  const point none = at(10, 0);
  const point wall = at(10.4F, 2000);
  for (const grid_options& options : {vendor_nearest, vendor_minimum}) {
    EXPECT_EQ(grid_of({none, wall}, 360, options)[10], 2.0F);
    EXPECT_EQ(grid_of({wall, none}, 360, options)[10], 2.0F);
    EXPECT_EQ(grid_of({none}, 360, options)[10], infinity);
    EXPECT_EQ(grid_of({none, none}, 360, options)[10], infinity);
  }
}

TEST(Grid, NoReturn_HasTheDirectionOfAFarTarget) {
  const made::packet packet = made::zero(20 * 64, 0);
  std::array<point, max_samples> out;
  const decoded got = decode(packet.view(), exact_correction{}, 0, out);
  ASSERT_FLOAT_EQ(got.points[0].angle_deg, 20.0F - 7.9905963F);
  std::vector<float> ranges_m(3600);
  fill_grid(got.points, ranges_m, vendor_nearest);
  for (std::size_t bin = 0; bin < ranges_m.size(); ++bin) {
    EXPECT_EQ(std::isinf(ranges_m[bin]), bin == 120U) << bin;  // 12.0094 degrees
    EXPECT_EQ(std::isnan(ranges_m[bin]), bin != 120U) << bin;
  }
  // Also across zero.
  EXPECT_EQ(grid_of({at(355.01F, 0)}, 360, vendor_nearest)[355], infinity);
}

TEST(Grid, TooNear_IsNeitherObstacleNorFree) {
  const point near = at(10, 60);
  const point far = at(10.4F, 4000);
  const point none = at(10, 0);
  for (const grid_pick pick : {grid_pick::nearest, grid_pick::minimum}) {
    const grid_options without{frame::vendor, pick, false};
    EXPECT_TRUE(std::isnan(grid_of({near}, 360, without)[10]));
    EXPECT_EQ(grid_of({near, far}, 360, without)[10], 4.0F);
    EXPECT_EQ(grid_of({far, near}, 360, without)[10], 4.0F);
    EXPECT_TRUE(std::isnan(grid_of({near, none}, 360, without)[10]));
    EXPECT_TRUE(std::isnan(grid_of({none, near}, 360, without)[10]));
    const grid_options with{frame::vendor, pick, true};
    EXPECT_FLOAT_EQ(grid_of({far, near}, 360, with)[10], 0.06F);
    EXPECT_FLOAT_EQ(grid_of({none, near}, 360, with)[10], 0.06F);
  }
}

TEST(Grid, OneBin_ContainsAllPoints) {
  const std::vector<point> points{at(10, 900), at(200, 300), at(355, 4000)};
  EXPECT_FLOAT_EQ(grid_of(points, 1, vendor_nearest)[0], 4.0F);  // 5 degrees from the middle
  EXPECT_FLOAT_EQ(grid_of(points, 1, vendor_minimum)[0], 0.3F);
}

/// The possible values of a bin, computed in double precision: all that are as good as the best,
/// except for rounding.
std::vector<float> allowed(const std::vector<point>& points, std::size_t bins, std::size_t bin,
                           const grid_options& options) {
  struct candidate {
    double off, range_m;
    int worth;
  };
  std::vector<candidate> inside;
  for (const point& p : points) {
    const bool none = p.range_mm == 0.0F;
    double native = static_cast<double>(p.angle_deg);
    if (options.to == frame::robot) native = -native;  // from -180 on: 180 - native + 180
    const double width = 360.0 / static_cast<double>(bins);
    const double off = std::fabs(std::remainder(native - static_cast<double>(bin) * width, 360.0));
    if (off > width / 2) continue;
    const bool usable = p.range_mm >= 100.0F || options.keep_too_near;
    inside.push_back({off, static_cast<double>(p.range_mm) / 1000.0, none ? 0 : usable ? 2 : 1});
  }
  int best_worth = -1;
  for (const candidate& c : inside) best_worth = std::max(best_worth, c.worth);
  if (best_worth < 0 || best_worth == 1) return {std::numeric_limits<float>::quiet_NaN()};
  if (best_worth == 0) return {infinity};
  double best = 1e9;
  const auto measure = [&](const candidate& c) {
    return options.pick == grid_pick::minimum ? c.range_m : c.off;
  };
  std::vector<float> result;
  for (const candidate& c : inside) {
    if (c.worth == 2) best = std::min(best, measure(c));
  }
  const double rounding = options.pick == grid_pick::minimum ? 0.0 : 1e-4;
  for (const candidate& c : inside) {
    if (c.worth == 2 && measure(c) <= best + rounding) {
      result.push_back(static_cast<float>(c.range_m));
    }
  }
  return result;
}

/// Points anywhere except within rounding of the edge between two bins.
std::vector<point> scattered(std::mt19937& source, std::size_t count, std::size_t bins) {
  const auto up_to = [&](unsigned n) { return static_cast<unsigned>(source() % n); };
  std::vector<point> points;
  while (points.size() < count) {
    const float angle_deg = static_cast<float>(up_to(360U << 14)) / 16384.0F;
    const unsigned kind = up_to(8);
    const float range_mm = kind == 0   ? 0.0F
                           : kind == 1 ? 0.25F * static_cast<float>(1 + up_to(399))
                                       : 0.25F * static_cast<float>(400 + up_to(65136));
    const point p = at(angle_deg, range_mm);
    const double width = 360.0 / static_cast<double>(bins);
    const double native = static_cast<double>(angle_deg);
    const double from_middle = std::fabs(std::remainder(native, width));
    if (std::fabs(from_middle - width / 2) > 2e-4) points.push_back(p);
  }
  return points;
}

void expect_reference(const std::vector<point>& points, std::size_t bins,
                      const grid_options& options) {
  const std::vector<float> got = grid_of(points, bins, options);
  for (std::size_t bin = 0; bin < bins; bin += bins > 1000 ? 7 : 1) {
    bool found = false;
    for (const float range_m : allowed(points, bins, bin, options)) {
      found = found || std::fabs(got[bin] - range_m) < 1e-5F ||
              (std::isnan(range_m) && std::isnan(got[bin])) || got[bin] == range_m;
    }
    ASSERT_TRUE(found) << "bin " << bin << " of " << bins << " holds " << got[bin];
  }
}

TEST(Grid, AgreesWithTheReferenceInBothFrames) {
  for (const int seed : test::seeds(1)) {
    SCOPED_TRACE(seed);
    std::mt19937 source(static_cast<std::uint32_t>(seed));
    for (const std::size_t bins : {1U, 7U, 360U, 1440U, 4000U}) {
      for (const std::size_t count : {10U, 300U, 1500U}) {
        if (bins * count > 2'000'000) continue;  // too slow under an emulator
        const std::vector<point> points = scattered(source, count, bins);
        for (const frame to : {frame::robot, frame::vendor}) {
          for (const grid_pick pick : {grid_pick::nearest, grid_pick::minimum}) {
            expect_reference(points, bins, {to, pick, count == 300U});
            if (HasFatalFailure()) return;
          }
        }
      }
    }
  }
}

TEST(Grid, WorksInConstantExpressions) {
  static_assert([] {
    const std::array<point, 2> points{at(180, 1000), at(90, 0)};
    std::array<float, 4> ranges_m{};
    fill_grid(points, ranges_m);
    return ranges_m[2] == 1.0F && ranges_m[3] == infinity && ranges_m[0] != ranges_m[0];
  }());
}

}  // namespace
}  // namespace g4lidar
