// SPDX-License-Identifier: MIT
// The two frames of reference: values computed by hand, and libm for the whole circle.
#include "g4lidar/cartesian.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "g4lidar/core/angle.hpp"
#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"

namespace g4lidar {
namespace {

constexpr point at(float angle_deg, float range_mm) {
  point p;
  p.angle_deg = angle_deg;
  p.range_mm = range_mm;
  p.time_ns = 77;
  if (range_mm == 0.0F) p.flags = point_flags::no_return;
  return p;
}

constexpr bool lies_at(const xy_point& p, double x, double y) {
  const double off_x = static_cast<double>(p.x_m) - x;
  const double off_y = static_cast<double>(p.y_m) - y;
  return off_x < 1e-6 && off_x > -1e-6 && off_y < 1e-6 && off_y > -1e-6;
}

// The robot looks away from the cable exit. Seen from above, the native angle grows clockwise from
// the cable exit at the back: over its left side, its front, and its right side.
static_assert(lies_at(to_xy(at(180, 2000), frame::robot), 2, 0), "in front");
static_assert(lies_at(to_xy(at(90, 2000), frame::robot), 0, 2), "to the left");
static_assert(lies_at(to_xy(at(270, 2000), frame::robot), 0, -2), "to the right");
static_assert(lies_at(to_xy(at(0, 2000), frame::robot), -2, 0), "behind, where the cable is");
static_assert(lies_at(to_xy(at(135, 1000), frame::robot), 0.7071068, 0.7071068), "front left");
static_assert(lies_at(to_xy(at(210, 1000), frame::robot), 0.8660254, -0.5), "front right");

// The vendor's frame has x at the cable exit and y at 90 degrees clockwise.
static_assert(lies_at(to_xy(at(0, 2000), frame::vendor), 2, 0));
static_assert(lies_at(to_xy(at(90, 2000), frame::vendor), 0, 2));
static_assert(lies_at(to_xy(at(180, 2000), frame::vendor), -2, 0));
static_assert(lies_at(to_xy(at(270, 2000), frame::vendor), 0, -2));
static_assert(lies_at(to_xy(at(30, 1000), frame::vendor), 0.8660254, 0.5));

static_assert(to_xy(at(30, 1000), frame::robot).time_ns == 77);

static_assert(bearing_deg(180.0F, frame::robot) == 0.0F);
static_assert(bearing_deg(90.0F, frame::robot) == 90.0F);
static_assert(bearing_deg(0.0F, frame::robot) == 180.0F);
static_assert(bearing_deg(270.0F, frame::robot) == 270.0F);
static_assert(bearing_deg(123.0F, frame::vendor) == 123.0F);

// An X4 looks at its 0 degrees: nothing is turned, only mirrored.
constexpr std::uint16_t not_turned = 0;
static_assert(lies_at(to_xy(at(0, 2000), frame::robot, not_turned), 2, 0), "in front");
static_assert(lies_at(to_xy(at(90, 2000), frame::robot, not_turned), 0, -2), "to the right");
static_assert(lies_at(to_xy(at(180, 2000), frame::robot, not_turned), -2, 0), "behind");
static_assert(lies_at(to_xy(at(270, 2000), frame::robot, not_turned), 0, 2), "to the left");
static_assert(lies_at(to_xy(at(330, 1000), frame::robot, not_turned), 0.8660254, 0.5));
static_assert(lies_at(to_xy(at(30, 1000), frame::vendor, not_turned), 0.8660254, 0.5));
static_assert(bearing_deg(0.0F, frame::robot, not_turned) == 0.0F);
static_assert(bearing_deg(90.0F, frame::robot, not_turned) == 270.0F);
static_assert(bearing_deg(270.0F, frame::robot, not_turned) == 90.0F);
static_assert(bearing_deg(123.0F, frame::vendor, not_turned) == 123.0F);

TEST(CoordinateFrames, AScan_IsTurnedAsItsModel) {
  const std::array<point, 2> points{at(0, 2000), at(270, 1000)};
  scan seen{.points = points, .model = model_named("x4")};
  std::array<xy_point, 2> places{};
  std::array<polar, 2> directions{};
  EXPECT_TRUE(lies_at(to_xy(seen, frame::robot, places)[0], 2, 0));
  EXPECT_TRUE(lies_at(places[1], 0, 1));
  EXPECT_FLOAT_EQ(to_polar(seen, frame::robot, directions)[1].bearing_rad,
                  std::numbers::pi_v<float> / 2);
  EXPECT_TRUE(lies_at(to_xy(seen.points, frame::robot, places)[1], 0, -1)) << "as a G4";
  seen.model = model_named("tg30");
  EXPECT_TRUE(lies_at(to_xy(seen, frame::robot, places)[0], -2, 0));
  EXPECT_FLOAT_EQ(to_polar(seen, frame::robot, directions)[1].bearing_rad,
                  -std::numbers::pi_v<float> / 2);
  EXPECT_TRUE(lies_at(to_xy(seen, frame::vendor, places)[1], 0, -1));
}

TEST(CoordinateFrames, PolarBearingsByHand) {
  constexpr float pi = std::numbers::pi_v<float>;
  const auto bearing = [](float angle_deg, frame to) {
    return to_polar(at(angle_deg, 1500), to).bearing_rad;
  };
  EXPECT_FLOAT_EQ(bearing(180, frame::robot), 0);
  EXPECT_FLOAT_EQ(bearing(90, frame::robot), pi / 2);
  EXPECT_FLOAT_EQ(bearing(270, frame::robot), -pi / 2);
  EXPECT_FLOAT_EQ(bearing(0, frame::robot), -pi);
  EXPECT_FLOAT_EQ(bearing(135, frame::robot), pi / 4);
  EXPECT_FLOAT_EQ(bearing(0, frame::vendor), 0);
  EXPECT_FLOAT_EQ(bearing(90, frame::vendor), pi / 2);
  EXPECT_FLOAT_EQ(bearing(180, frame::vendor), -pi);
  EXPECT_FLOAT_EQ(bearing(270, frame::vendor), -pi / 2);
  EXPECT_FLOAT_EQ(to_polar(at(10, 1500), frame::robot).range_m, 1.5F);
}

TEST(CoordinateFrames, PolarOfManyPointsIsThatOfEach) {
  const std::array<point, 3> points{at(10, 1500), at(350, 0), at(180, 16000)};
  std::array<polar, 4> out{};
  const std::span<polar> got = to_polar(points, frame::robot, out);
  ASSERT_EQ(got.size(), 3U);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(got[i].bearing_rad, to_polar(points[i], frame::robot).bearing_rad);
    EXPECT_EQ(got[i].range_m, to_polar(points[i], frame::robot).range_m);
  }
}

TEST(CoordinateFrames, Time_IsOfTheMonotonicClock) {
  EXPECT_EQ(at(0, 0).time().time_since_epoch(), std::chrono::nanoseconds(77));
  EXPECT_EQ(point().time(), std::chrono::steady_clock::time_point());
}

TEST(CoordinateFrames, NoReturn_HasTheDirectionOfAFarTarget) {
  const point none = at(100.0F - 7.9905963F, 0);
  const polar seen = to_polar(none, frame::vendor);
  EXPECT_EQ(seen.range_m, 0.0F);
  EXPECT_NEAR(seen.bearing_rad, (100.0 - 7.9905963) * std::numbers::pi / 180.0, 1e-6);
  for (const frame to : {frame::robot, frame::vendor}) {
    const xy_point nowhere = to_xy(none, to);
    EXPECT_TRUE(std::isnan(nowhere.x_m));
    EXPECT_TRUE(std::isnan(nowhere.y_m));
    EXPECT_EQ(nowhere.time_ns, 77);
  }
}

/// Angles of the whole circle, and the neighbours of angles at which the computation changes.
std::vector<float> angles() {
  std::vector<float> all;
  for (int step = 0; step < 360 * 128; ++step) all.push_back(static_cast<float>(step) / 128.0F);
  for (int edge = 0; edge <= 360; edge += 45) {
    const auto exact = static_cast<float>(edge);
    float below = exact;
    float above = exact;
    for (int i = 0; i < 20; ++i) {
      below = std::nextafter(below, -1.0F);
      above = std::nextafter(above, 361.0F);
      if (below >= 0.0F) all.push_back(below);
      if (above < 360.0F) all.push_back(above);
    }
  }
  for (float tiny = 1e-38F; tiny < 1.0F; tiny *= 3.0F) all.push_back(tiny);
  return all;
}

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

TEST(CoordinateFrames, Bearings_AreInTheHalfOpenRange) {
  constexpr float pi = std::numbers::pi_v<float>;
  for (const float angle_deg : angles()) {
    for (const float range_mm : {0.0F, 1000.0F}) {
      for (const auto& [to, turn_deg] : {std::pair{frame::robot, 180}, std::pair{frame::robot, 0},
                                         std::pair{frame::vendor, 0}}) {
        const auto turn = static_cast<std::uint16_t>(turn_deg);
        const point p = at(angle_deg, range_mm);
        const float direction = p.angle_deg;
        const float turned = bearing_deg(direction, to, turn);
        ASSERT_GE(turned, 0.0F);
        ASSERT_LT(turned, 360.0F) << direction;
        const float bearing_rad = to_polar(p, to, turn).bearing_rad;
        ASSERT_GE(bearing_rad, -pi) << angle_deg;
        ASSERT_LT(bearing_rad, pi) << angle_deg;
        const double ideal = to == frame::robot ? turn_deg - static_cast<double>(direction)
                                                : static_cast<double>(direction);
        const double off = static_cast<double>(bearing_rad) - radians(ideal);
        ASSERT_LT(std::fabs(std::remainder(off, 2.0 * std::numbers::pi)), 5e-7) << angle_deg;
      }
    }
  }
}

TEST(SineCosine, IsWithinItsBoundOfLibm) {
  double worst = 0.0;
  for (const float degrees : angles()) {
    const sine_cosine got = sine_cosine_deg(degrees);
    const double truth = radians(static_cast<double>(degrees));
    worst = std::max({worst, std::fabs(static_cast<double>(got.sine) - std::sin(truth)),
                      std::fabs(static_cast<double>(got.cosine) - std::cos(truth))});
  }
  EXPECT_LT(worst, 1.2e-7);
}

TEST(Cartesian, IsWithinItsBoundOfLibm) {
  double worst = 0.0;
  for (const float range_mm : {0.25F, 155.25F, 333.5F, 1000.0F, 7161.25F, 16383.75F}) {
    for (const float angle_deg : angles()) {
      const double truth = radians(static_cast<double>(angle_deg));
      const double range_m = static_cast<double>(range_mm) / 1000.0;
      const xy_point vendor = to_xy(at(angle_deg, range_mm), frame::vendor);
      const xy_point robot = to_xy(at(angle_deg, range_mm), frame::robot);
      worst = std::max(
          {worst, std::fabs(static_cast<double>(vendor.x_m) - range_m * std::cos(truth)) / range_m,
           std::fabs(static_cast<double>(vendor.y_m) - range_m * std::sin(truth)) / range_m});
      ASSERT_EQ(robot.x_m, -vendor.x_m);
      ASSERT_EQ(robot.y_m, vendor.y_m);
      const xy_point ahead = to_xy(at(angle_deg, range_mm), frame::robot, not_turned);
      ASSERT_EQ(ahead.x_m, vendor.x_m);
      ASSERT_EQ(ahead.y_m, -vendor.y_m);
    }
  }
  EXPECT_LT(worst, 2e-7);
}

TEST(Cartesian, AgreesWithPolarInBothFrames) {
  for (int angle = 0; angle < 360; angle += 7) {
    for (const frame to : {frame::robot, frame::vendor}) {
      const point p = at(static_cast<float>(angle), 3000);
      const xy_point xy = to_xy(p, to);
      const polar direction = to_polar(p, to);
      EXPECT_NEAR(xy.x_m, direction.range_m * std::cos(direction.bearing_rad), 2e-6F);
      EXPECT_NEAR(xy.y_m, direction.range_m * std::sin(direction.bearing_rad), 2e-6F);
    }
  }
}

TEST(Cartesian, WritesAllPointsAndNoMore) {
  const std::array<point, 3> points{at(0, 1000), at(90, 0), at(180, 2000)};
  std::array<xy_point, 4> out{};
  out.fill({5, 5, 5});
  const std::span<xy_point> written = to_xy(points, frame::robot, out);
  ASSERT_EQ(written.size(), 3U);
  EXPECT_EQ(written.data(), out.data());
  EXPECT_FLOAT_EQ(written[0].x_m, -1.0F);
  EXPECT_TRUE(std::isnan(written[1].x_m));
  EXPECT_FLOAT_EQ(written[2].x_m, 2.0F);
  EXPECT_EQ(out[3].x_m, 5.0F);
  EXPECT_TRUE(to_xy(std::span<const point>(), frame::robot, out).empty());
}

}  // namespace
}  // namespace g4lidar
