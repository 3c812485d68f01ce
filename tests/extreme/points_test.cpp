// SPDX-License-Identifier: MIT
// Points, grids, filters and marks, with extreme numbers.
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "g4lidar/cartesian.hpp"
#include "g4lidar/filter.hpp"
#include "g4lidar/filter/outliers.hpp"
#include "g4lidar/filter/plausibility.hpp"
#include "g4lidar/filter/too_near.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/point.hpp"
#include "numbers.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::extreme;

TEST(ExtremePoints, Directions) {
  with_extremes<float, frame, std::uint16_t>([](float direction, frame to, std::uint16_t turn_deg) {
    use(bearing_deg(direction, to, turn_deg));
  });
  many_times([](test::dice& random) {
    const point p = any<point>(random);
    const auto to = any<frame>(random);
    const auto turn_deg = any<std::uint16_t>(random);
    use(raw_angle_deg(p, any<correction_kind>(random)));
    use(to_polar(p, to, turn_deg));
    use(to_xy(p, to, turn_deg));
    use(p.time());
    use(without(p.flags, any<point_flags>(random)));
    const std::vector<point> points = several<point>(random, 40);
    std::vector<polar> polars(points.size());
    std::vector<xy_point> places(points.size());
    use(to_polar(points, to, polars, turn_deg));
    use(to_xy(points, to, places, turn_deg));
  });
}

TEST(ExtremePoints, PlacesInAGrid) {
  with_extremes<float, std::size_t>([](float direction, std::size_t bins) {
    for (const frame to : values<frame>()) {
      for (const std::uint16_t turn_deg : std::initializer_list<std::uint16_t>{0, 180, 65'535}) {
        const grid_place place = place_in_grid(direction, to, bins, turn_deg);
        EXPECT_TRUE(place.bin < bins || (bins == 0 && place.bin == 0))
            << direction << " is in bin " << place.bin << " of " << bins;
      }
    }
  });
  many_times([](test::dice& random) {
    model which = g4_model;
    which.rates.nominal_hz = any<std::uint32_t>(random);
    use(default_bins(which));
  });
}

grid_options any_grid(test::dice& random) {
  return {any<frame>(random),        any<grid_pick>(random), any<bool>(random),
          any<no_return_as>(random), any<bool>(random),      any<std::uint16_t>(random),
          any<float>(random)};
}

TEST(ExtremePoints, Grids) {
  many_times([](test::dice& random) {
    const std::vector<point> points = several<point>(random, 100);
    std::vector<float> ranges_m(random.below(100));
    std::vector<float> intensities(random.below(200));
    fill_grid(points, ranges_m, any_grid(random), intensities);
    scan source;
    source.points = points;
    fill_grid(source, ranges_m, any_grid(random));
  });
}

// What has no direction is nowhere, and hides nothing.
TEST(ExtremePoints, WithoutDirectionInNoBin) {
  for (const float none : {std::numeric_limits<float>::quiet_NaN(),
                           std::numeric_limits<float>::infinity(), -1e30F, 1e30F}) {
    const std::array<point, 2> points{point{.angle_deg = none, .range_mm = 100.0F},
                                      point{.angle_deg = 0.0F, .range_mm = 2000.0F}};
    std::array<float, 4> ranges_m{};
    fill_grid(points, ranges_m, {.to = frame::vendor, .pick = grid_pick::minimum});
    EXPECT_EQ(ranges_m[0], 2.0F) << none;
    for (const std::size_t bin : {1U, 2U, 3U}) EXPECT_TRUE(std::isnan(ranges_m[bin])) << none;
  }
}

TEST(ExtremePoints, NoBins) {
  std::array<point, 3> points{};
  std::array<float, 3> intensities{1.0F, 1.0F, 1.0F};
  fill_grid(points, std::span<float>(), {}, intensities);
  EXPECT_EQ(intensities[0], 1.0F);
}

TEST(ExtremePoints, Filters) {
  with_extremes<double, double>([](double from, double to) {
    const sector made(from, to);
    for (const double degrees : {0.0, 90.0, 359.9}) use(made.has(degrees));
    use(made.is_everything());
  });
  many_times([](test::dice& random) {
    std::vector<sector> ignored;
    for (std::size_t i = random.below(3); i-- > 0;)
      ignored.emplace_back(any<double>(random), any<double>(random));
    std::vector<corner> corners(random.below(5));
    for (corner& each : corners) each = {any<float>(random), any<float>(random)};
    use(is_inside({any<float>(random), any<float>(random)}, corners));
    const std::array<polygon, 1> masks{polygon(corners)};
    const point_filter filter{any<frame>(random),
                              any<std::uint16_t>(random),
                              sector(any<double>(random), any<double>(random)),
                              ignored,
                              masks,
                              any<float>(random),
                              any<float>(random),
                              any<bool>(random),
                              any<bool>(random),
                              any<point_flags>(random)};
    const std::vector<point> points = several<point>(random, 40);
    std::vector<point> out(points.size());
    use(filter.keeps_everything());
    for (const point& p : points) {
      use(filter.keeps(p));
      use(filter.has_direction(p) || filter.has_range(p) || filter.has_place(p) ||
          filter.has_flags(p));
    }
    use(filter_points(points, filter, out));
    use(filter_for_grid(points, filter, out));
  });
}

TEST(ExtremePoints, Marks) {
  many_times([](test::dice& random) {
    std::vector<point> points = several<point>(random, 60);
    std::vector<point> out(points.size());
    const auto ends = any<scan_ends>(random);
    const speckle_limits speckle{any<std::size_t>(random), any<std::size_t>(random),
                                 any<float>(random), any<float>(random)};
    use(speckle.near_ratio_at(any<float>(random)));
    use(mark_isolated(points, out, speckle, ends));
    use(mark_veiling(points, out, {any<std::size_t>(random), any<float>(random)}, ends));
    use(mark_bit_errors(points, {any<float>(random), any<float>(random)},
                        any<sample_layout>(random)));
    mark_unlikely(points);
    near_history history;
    const near_limits limits{any<float>(random), any<std::uint32_t>(random)};
    use(limits.shortest_mm_of(g4_model, any<std::uint32_t>(random)));
    use(mark_near(points, history, limits, models[random.below(models.size())],
                  any<std::uint32_t>(random)));
    use(history.add(any<point>(random), limits, g4_model, any<std::uint32_t>(random)));
    sample_spacing spacing(g4_model);
    spacing.add(points);
    use(spacing.step_deg());
  });
}

// The nearest window that there can be.
TEST(ExtremePoints, Windows) {
  std::vector<point> points(40);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = {.angle_deg = 0.3F * static_cast<float>(i),
                 .range_mm = i == 20 ? 1000.0F : 4000.0F};
  }
  const auto marked = [&](std::size_t window) {
    std::vector<point> out(points.size());
    mark_isolated(points, out, {.window = window, .count = 3});
    return out;
  };
  EXPECT_EQ(marked(0), marked(1));
  EXPECT_EQ(marked(std::numeric_limits<std::size_t>::max()), marked(max_window));
}

TEST(ExtremePoints, Scans) {
  many_times([](test::dice& random) {
    const std::vector<point> points = several<point>(random, 10);
    scan s;
    s.points = points;
    s.flags = any<scan_flags>(random);
    s.sample_rate_hz = any<std::uint32_t>(random);
    s.turned_deg = any<float>(random);
    s.duration_ns = any<std::int64_t>(random);
    use(s.end_ns());
    use(s.end_time());
    use(s.time());
    use(s.measured_sample_rate_hz());
    use(s.measured_frequency_hz());
    use(s.has(any<scan_flags>(random)));
    std::vector<polar> out(points.size());
    use(to_polar(s, any<frame>(random), out));
  });
}

}  // namespace
