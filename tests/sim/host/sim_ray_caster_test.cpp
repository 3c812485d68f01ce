// SPDX-License-Identifier: MIT
// The curved rays of the simulator, compared with small steps along the beam with libm.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <vector>

#include "g4lidar/sim/random.hpp"
#include "g4lidar/sim/ray_caster.hpp"

namespace {

using namespace g4lidar;

constexpr double radian = std::numbers::pi / 180.0;

int scale() {
  const char* const text = std::getenv("G4LIDAR_TEST_SCALE");
  return text != nullptr ? std::max(1, std::atoi(text)) : 1;
}

struct point {
  double x;
  double y;
};

// The reference's own correction, with libm and the formula of the manual.
double reference_correction_deg(double d) {
  return std::atan(21.8 * (155.3 - d) / (155.3 * d)) / radian;
}

// The position of a target at this range and bearing in the world, in metres.
point stands_at(const sim::pose& lidar, double range_mm, double bearing_deg) {
  const double direction = (lidar.heading_deg - bearing_deg) * radian;
  return {lidar.x_m + range_mm / 1000.0 * std::cos(direction),
          lidar.y_m + range_mm / 1000.0 * std::sin(direction)};
}

double distance_m(point p, const sim::wall& w) {
  const double dx = w.x2_m - w.x1_m;
  const double dy = w.y2_m - w.y1_m;
  const double along =
      std::clamp(((p.x - w.x1_m) * dx + (p.y - w.y1_m) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return std::hypot(p.x - w.x1_m - along * dx, p.y - w.y1_m - along * dy);
}

double cross(point o, point a, point b) {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

bool crosses(point a, point b, const sim::wall& w) {
  const point c{w.x1_m, w.y1_m};
  const point d{w.x2_m, w.y2_m};
  return (cross(a, b, c) > 0.0) != (cross(a, b, d) > 0.0) &&
         (cross(c, d, a) > 0.0) != (cross(c, d, b) > 0.0);
}

// The points of the beam at ranges that grow by 0.05 mm at small and by 1 mm at large ranges.
class walked_beam {
 public:
  explicit walked_beam(double longest_mm) {
    for (double d = 1.0; d < longest_mm; d += std::max(0.05, std::min(d * 0.0005, 1.0))) {
      ranges_.push_back(d);
      corrections_.push_back(reference_correction_deg(d));
    }
  }

  struct step {
    double from_mm;
    double to_mm;
  };

  // The first step along the beam that crosses a wall.
  [[nodiscard]] std::optional<step> first_crossing(const sim::world& world, double theta) const {
    point here = stands_at(world.lidar, ranges_[0], theta + corrections_[0]);
    for (std::size_t i = 1; i < ranges_.size(); ++i) {
      const point next = stands_at(world.lidar, ranges_[i], theta + corrections_[i]);
      for (const sim::wall& w : world.walls) {
        if (crosses(here, next, w)) return step{ranges_[i - 1], ranges_[i]};
      }
      here = next;
    }
    return std::nullopt;
  }

 private:
  std::vector<double> ranges_;
  std::vector<double> corrections_;
};

double distance_to_walls_m(const sim::world& world) {
  double least = 1e9;
  for (const sim::wall& w : world.walls) {
    least = std::min(least, distance_m({world.lidar.x_m, world.lidar.y_m}, w));
  }
  return least;
}

// Some random walls, a few of them very near or very short.
sim::world random_world(sim::random_stream& random) {
  sim::world world;
  const auto between = [&random](double low, double high) {
    return low + (high - low) * random.uniform();
  };
  world.lidar = {between(-3.0, 3.0), between(-3.0, 3.0), between(-360.0, 360.0)};
  const auto walls = static_cast<std::size_t>(between(1.0, 9.0));
  while (world.walls.size() < walls) {
    const double spread = std::exp2(between(-4.0, 3.0));
    const double x = world.lidar.x_m + between(-spread, spread);
    const double y = world.lidar.y_m + between(-spread, spread);
    const double length = std::exp2(between(-6.0, 3.5));
    const double turn = between(0.0, 360.0) * radian;
    world.walls.push_back({x, y, x + length * std::cos(turn), y + length * std::sin(turn)});
    if (distance_to_walls_m(world) < sim::min_clearance_m) world.walls.pop_back();
  }
  return world;
}

TEST(SimRayCaster, Target_IsTheNearestOnTheBeam) {
  sim::random_stream random(12);
  const walked_beam beam(20'000.0);
  std::size_t met = 0;
  std::size_t empty = 0;
  for (int i = 0; i < 40 * scale(); ++i) {
    const sim::world world = random_world(random);
    const sim::ray_caster caster(world);
    for (int ray = 0; ray < 10; ++ray) {
      const double theta = random.uniform() * 360.0;
      const auto seen = caster.cast(theta);
      const auto walked = beam.first_crossing(world, theta);
      if (walked) {
        ASSERT_TRUE(seen) << "world " << i << " theta " << theta << " walked " << walked->to_mm;
        // The steps deviate from the curve by far less than this. A nearer target is one that a
        // step has passed over.
        ASSERT_LT(seen->range_mm, walked->to_mm + 0.01) << "world " << i << " theta " << theta;
        ++met;
      } else {
        ++empty;
      }
    }
  }
  EXPECT_GT(met, 100U);
  EXPECT_GT(empty, 20U);
}

TEST(SimRayCaster, BeamThatCrossesAWallTwice_HitsTheNearerPoint) {
  // The curved beam at theta 0 deviates to one side at about 200 mm. Walls along its chord, a
  // little to either side, are hit twice or not at all.
  const walked_beam beam(2'000.0);
  std::size_t twice = 0;
  for (int i = 0; i <= 400; ++i) {
    sim::world world;
    const point a = stands_at({}, 60.0, reference_correction_deg(60.0));
    const point b = stands_at({}, 900.0, reference_correction_deg(900.0));
    const double shift = (i - 200) * 5e-5;
    world.walls.push_back({a.x, a.y + shift, b.x, b.y + shift});
    const auto seen = sim::ray_caster(world).cast(0.0);
    const auto walked = beam.first_crossing(world, 0.0);
    ASSERT_EQ(seen.has_value(), walked.has_value()) << i;
    if (!seen) continue;
    ASSERT_GT(seen->range_mm, walked->from_mm - 0.05) << i;
    ASSERT_LT(seen->range_mm, walked->to_mm + 0.05) << i;
    twice += seen->range_mm < 400.0 ? 1U : 0U;
  }
  EXPECT_GT(twice, 5U);
}

}  // namespace
