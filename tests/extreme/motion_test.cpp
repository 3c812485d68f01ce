// SPDX-License-Identifier: MIT
// Motion, deskewing, merging and shaping, with extreme numbers.
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "g4lidar/lidar.hpp"
#include "g4lidar/merge.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/motion/deskew.hpp"
#include "g4lidar/motion/odometry_feed.hpp"
#include "g4lidar/motion/twist_estimator.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "numbers.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::extreme;

constexpr std::int64_t most_ns = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t least_ns = std::numeric_limits<std::int64_t>::min();

static_assert(merged{}.is_lost(32) && merged{}.is_lost(std::numeric_limits<std::size_t>::max()));
static_assert(!merged{}.is_lost(31));
static_assert(interpolated({least_ns, {}}, {most_ns, {1.0, 0.0, 0.0}}, 0).x_m > 0.4);
static_assert(rotation_by(1e300).sine != rotation_by(1e300).sine);

TEST(ExtremeMotion, Poses) {
  with_extremes<double>([](double x) {
    const rotation turned = rotation_by(x);
    const double wrapped = wrap_rad(x);
    EXPECT_EQ(std::isnan(turned.sine), !(std::abs(x) < 4e18 * 1.57)) << x;
    EXPECT_TRUE(std::isnan(wrapped) || std::abs(wrapped) < 1e4) << x << " gives " << wrapped;
  });
  many_times([](test::dice& random) {
    const pose_2d a = any<pose_2d>(random);
    const twist_2d twist = any<twist_2d>(random);
    use(a * any<pose_2d>(random));
    use(inverse(a));
    use(moved_by(twist, any<double>(random)));
    use(twist_to(a, any<double>(random)));
    use(seen_from(a, twist));
    use(any<mounting>(random).upright(twist));
    use(interpolated(any<stamped_pose>(random), any<stamped_pose>(random),
                     any<std::int64_t>(random)));
    const std::vector<stamped_pose> path = several<stamped_pose>(random, 6);
    const auto time_ns = any<std::int64_t>(random);
    const auto piece = piece_at(path, time_ns, any<std::size_t>(random));
    EXPECT_TRUE(!piece || *piece + 1 < path.size());
    use(pose_at(path, time_ns));
  });
}

// Points that are near enough in time for a block, so that its arithmetic is reached.
std::vector<point> any_row(test::dice& random) {
  std::vector<point> made = several<point>(random, 200);
  const auto begin_ns = any<std::int64_t>(random);
  if (random.below(4) == 0) return made;
  for (point& p : made) {
    if (random.below(8) != 0)
      p.time_ns =
          detail::saturating_add(begin_ns, static_cast<std::int64_t>(random.below(2'000'000'000)));
  }
  return made;
}

TEST(ExtremeMotion, Deskewing) {
  many_times([](test::dice& random) {
    const std::vector<point> points = any_row(random);
    std::vector<point> out(points.size());
    const auto reference_ns = any<std::int64_t>(random);
    const auto mount = any<mounting>(random);
    const auto turn_deg = any<std::uint16_t>(random);
    use(deskew(points, any<twist_2d>(random), reference_ns, out, mount, turn_deg));
    std::vector<stamped_pose> path = several<stamped_pose>(random, 6);
    if (random.below(2) == 0) std::ranges::sort(path, {}, &stamped_pose::time_ns);
    use(deskew(points, path, reference_ns, out, mount, turn_deg));
    const auto function = [&](std::int64_t) -> std::optional<pose_2d> {
      if (random.below(8) == 0) return {};
      return any<pose_2d>(random);
    };
    use(deskew(points, function, reference_ns, out, mount, turn_deg));

    std::vector<mounted_scan> lidars(random.below(4));
    for (mounted_scan& each : lidars)
      each = {points, any<mounting>(random), any<std::uint16_t>(random)};
    out.resize(lidars.size() * points.size());
    const auto fresh_ns = any<std::int64_t>(random);
    use(merge_scans(lidars, any<twist_2d>(random), reference_ns, out, fresh_ns));
    use(merge_scans(lidars, path, reference_ns, out, fresh_ns));
    const merged all = merge_scans(lidars, function, reference_ns, out, fresh_ns);
    use(all.is_lost(any<std::size_t>(random)));
  });
}

// The result is as far as possible, and not of another time.
TEST(ExtremeMotion, TimesFarApart) {
  std::vector<point> points(3, point{.angle_deg = 10.0F, .range_mm = 1000.0F, .time_ns = most_ns});
  const twist_2d slow{.x_m_per_s = 1e-12};
  const deskewed made = deskew(points, slow, least_ns);
  EXPECT_EQ(made.outside, 0U);
  EXPECT_NEAR(made.points[0].range_mm, 1000.0F, 20.0F);  // 9.2e9 s at 1e-12 m/s are 9.2 mm
  const std::vector<mounted_scan> lidars{{points, {}, 180}};
  std::vector<point> out(3);
  EXPECT_EQ(merge_scans(lidars, slow, least_ns, out).lost, 1U);
  EXPECT_EQ(merge_scans(lidars, slow, most_ns, out).lost, 0U);
}

shaping_options any_shaping(test::dice& random) {
  shaping_options made;
  if (random.below(2) == 0)
    made.marks.speckle = speckle_limits{any<std::size_t>(random), any<std::size_t>(random),
                                        any<float>(random), any<float>(random)};
  if (random.below(2) == 0)
    made.marks.edges = edge_limits{any<std::size_t>(random), any<float>(random)};
  if (random.below(2) == 0)
    made.marks.near = near_limits{any<float>(random), any<std::uint32_t>(random)};
  made.deskew = any<deskewing>(random);
  made.mount = any<mounting>(random);
  made.restamps = any<bool>(random);
  made.filter.least_range_mm = any<float>(random);
  made.filter.field_of_view = sector(any<double>(random), any<double>(random));
  EXPECT_LE(made.marks.window(), max_window);
  return made;
}

TEST(ExtremeMotion, Shaping) {
  many_times(
      [](test::dice& random) {
        scan_shaper shaper(any_shaping(random));
        for (int i = 0; i < 4; ++i) {
          const std::vector<point> points = any_row(random);
          scan source;
          source.points = points;
          source.sample_rate_hz = any<std::uint32_t>(random);
          source.duration_ns = any<std::int64_t>(random);
          const std::vector<stamped_pose> path = several<stamped_pose>(random, 4);
          shaper.shape(source, path);
          use(shaper.kept());
          use(shaper.for_grid());
          if (random.below(4) == 0) shaper.set_options(any_shaping(random));
          const owned_scan kept(source);
          use(kept.view());
        }
      },
      200);
}

TEST(ExtremeMotion, Estimator) {
  twist_estimator estimator;
  many_times(
      [&](test::dice& random) {
        std::vector<point> points(600);
        const auto begin_ns = random.below(3) == 0 ? any<std::int64_t>(random) : 1'000'000'000;
        const auto shortest_mm = any<std::uint16_t>(random);
        for (std::size_t i = 0; i < points.size(); ++i) {
          points[i] = {.angle_deg = 0.6F * static_cast<float>(i),
                       .range_mm = 1000.0F + static_cast<float>(random.below(50))};
          if (random.below(8) == 0) points[i] = any<point>(random);
          if (random.below(8) == 0) points[i].range_mm = any<float>(random);
          points[i].time_ns =
              detail::saturating_add(begin_ns, static_cast<std::int64_t>(i) * 200'000);
        }
        if (random.below(4) == 0) points = several<point>(random, 100);
        const twist_estimate made = estimator.add(points, any<std::uint16_t>(random), shortest_mm);
        EXPECT_TRUE(!made.is_known() || std::isfinite(made.twist.x_m_per_s));
      },
      300);
}

TEST(ExtremeMotion, OdometryPath) {
  odometry_path path;
  many_times([&](test::dice& random) {
    path.add(any<stamped_odometry>(random));
    use(path.until(any<std::int64_t>(random)));
  });
}

TEST(ExtremeMotion, OdometryFeed) {
  many_times(
      [](test::dice& random) {
        odometry_feed feed;
        std::vector<stamped_odometry> all = several<stamped_odometry>(random, 6);
        std::ranges::sort(all, {}, &stamped_odometry::time_ns);
        feed.set(all);
        for (int i = 0; i < 4; ++i) {
          feed.shift(any<std::int64_t>(random));
          feed.follow(several<point>(random, 5), [](const stamped_odometry& what) { use(what); });
        }
      },
      1000);
}

}  // namespace
