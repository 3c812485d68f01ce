// SPDX-License-Identifier: MIT
// What a lidar sees that drives among walls and people, compared with a slow computation with libm;
// and the worlds of examples/worlds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "g4lidar/sim/scanner.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4lidar;

constexpr double radian = std::numbers::pi / 180.0;

struct spot {
  double x;
  double y;
};

// The point of the beam at this range, by the manual's formula.
spot on_beam(const sim::pose& lidar, double first_level_deg, double range_m) {
  const double d = range_m * 1000.0;
  const double bearing = first_level_deg * radian + std::atan(21.8 * (155.3 - d) / (155.3 * d));
  const double direction = lidar.heading_deg * radian - bearing;
  return {lidar.x_m + range_m * std::cos(direction), lidar.y_m + range_m * std::sin(direction)};
}

double distance_m(spot p, const sim::wall& w) {
  const double dx = w.x2_m - w.x1_m;
  const double dy = w.y2_m - w.y1_m;
  const double along =
      std::clamp(((p.x - w.x1_m) * dx + (p.y - w.y1_m) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return std::hypot(p.x - w.x1_m - along * dx, p.y - w.y1_m - along * dy);
}

// Where somebody is who walks to and fro.
spot at_time(const sim::disc& d, double seconds) {
  const double way = std::hypot(d.to_x_m - d.x_m, d.to_y_m - d.y_m);
  if (d.speed_m_per_s == 0.0 || way == 0.0) return {d.x_m, d.y_m};
  const double gone = std::fmod(seconds * d.speed_m_per_s, 2.0 * way);
  const double part = (gone < way ? gone : 2.0 * way - gone) / way;
  return {d.x_m + part * (d.to_x_m - d.x_m), d.y_m + part * (d.to_y_m - d.y_m)};
}

double distance_m(spot p, const sim::disc& d, double seconds) {
  const spot centre = at_time(d, seconds);
  return std::hypot(p.x - centre.x, p.y - centre.y) - d.radius_m;
}

double side_of(spot o, spot a, spot b) {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

// But for the last millimetre at both ends.
bool crosses(spot a, spot b, const sim::wall& w) {
  const double length = std::hypot(w.x2_m - w.x1_m, w.y2_m - w.y1_m);
  const double x = (w.x2_m - w.x1_m) / length * 1e-3;
  const double y = (w.y2_m - w.y1_m) / length * 1e-3;
  const spot c{w.x1_m + x, w.y1_m + y};
  const spot d{w.x2_m - x, w.y2_m - y};
  return length > 0.003 && (side_of(a, b, c) > 0.0) != (side_of(a, b, d) > 0.0) &&
         (side_of(c, d, a) > 0.0) != (side_of(c, d, b) > 0.0);
}

// Whether a target is before `end_m`.
bool is_nearer(const sim::world& world, const sim::sample_truth& truth, double end_m) {
  const double seconds = static_cast<double>(truth.time_ns) * 1e-9;
  double d = 0.05;
  spot here = on_beam(truth.lidar, truth.first_level_deg, d);
  while (d < end_m) {
    d = std::min(d + std::min(0.02 * d, 0.05), end_m);
    const spot next = on_beam(truth.lidar, truth.first_level_deg, d);
    for (const sim::wall& w : world.walls) {
      if (crosses(here, next, w)) return true;
    }
    for (const sim::disc& each : world.discs) {
      if (distance_m(next, each, seconds) < -1e-6) return true;
    }
    here = next;
  }
  return false;
}

void check(const sim::world& world, const sim::sample_truth& truth) {
  const double seconds = static_cast<double>(truth.time_ns) * 1e-9;
  SCOPED_TRACE("time " + std::to_string(seconds) + " s, angle " +
               std::to_string(truth.first_level_deg) + ", range " + std::to_string(truth.range_mm));
  if (!world.path.empty()) {
    // The cable is opposite to where the lidar looks.
    const sim::pose& at = world.mounted_at;
    const sim::pose cable{at.x_m, at.y_m,
                          at.heading_deg > 0 ? at.heading_deg - 180.0 : at.heading_deg + 180.0};
    EXPECT_EQ(truth.lidar, sim::placed(sim::robot_at(world.path, truth.time_ns).at, cable));
  }
  if (truth.range_mm == 0.0) {
    EXPECT_FALSE(is_nearer(world, truth, 30.0));
    return;
  }
  const double range_m = truth.range_mm / 1000.0;
  const double direction = (truth.lidar.heading_deg - truth.bearing_deg) * radian;
  const spot target{truth.lidar.x_m + range_m * std::cos(direction),
                    truth.lidar.y_m + range_m * std::sin(direction)};
  double off = 1e9;
  for (const sim::wall& w : world.walls) off = std::min(off, distance_m(target, w));
  for (const sim::disc& d : world.discs) {
    off = std::min(off, std::fabs(distance_m(target, d, seconds)));
  }
  EXPECT_LT(off, 1e-9);
  EXPECT_FALSE(is_nearer(world, truth, range_m - 1e-6));
}

sim::world parsed(const std::string& text) {
  auto read = sim::parse_world(text);
  if (const auto* error = std::get_if<sim::world_error>(&read)) {
    ADD_FAILURE() << "line " << error->line << ": " << error->message;
    return {};
  }
  return std::get<sim::world>(std::move(read));
}

sim::world example(const std::string& name) {
  std::ifstream in(G4LIDAR_SOURCE_DIR "/examples/worlds/" + name + ".txt");
  EXPECT_TRUE(in.good());
  return parsed({std::istreambuf_iterator<char>(in), {}});
}

class ExampleWorld : public testing::TestWithParam<const char*> {};

TEST_P(ExampleWorld, EachSampleIsTheFirstTargetFromWhereTheLidarIs) {
  const sim::world world = example(GetParam());
  sim::scanner scanner(world, {});
  const int every = std::max(1, 200 / test::test_scale());
  const std::int64_t end_ns = world.path.back().time_ns + 1'000'000'000;
  std::size_t targets = 0;
  for (std::int64_t now = 0; now < end_ns;) {
    const sim::sent_packet packet = scanner.next();
    now = packet.complete_ns;
    for (const sim::sample_truth& truth : packet.samples) {
      if (truth.index % static_cast<std::uint64_t>(every) != 0) continue;
      check(world, truth);
      if (testing::Test::HasFailure()) return;
      targets += truth.range_mm > 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(targets, 100U);
}

TEST_P(ExampleWorld, ThePathStays20CentimetresFromEverything) {
  const sim::world world = example(GetParam());
  ASSERT_GE(world.path.size(), 2U);
  double least = 1e9;
  for (std::int64_t now = 0; now <= world.path.back().time_ns; now += 10'000'000) {
    const sim::pose robot = sim::robot_at(world.path, now).at;
    const spot here{robot.x_m, robot.y_m};
    for (const sim::wall& w : world.walls) least = std::min(least, distance_m(here, w));
    for (const sim::disc& d : world.discs) {
      least = std::min(least, distance_m(here, d, static_cast<double>(now) * 1e-9));
    }
  }
  EXPECT_GE(least, 0.2);
}

TEST_P(ExampleWorld, ThePathEndsWhereItBegins) {
  const std::vector<sim::path_point> path = example(GetParam()).path;
  const sim::pose begin = path.front().robot.at;
  const sim::pose end = path.back().robot.at;
  EXPECT_NEAR(begin.x_m, end.x_m, 1e-9);
  EXPECT_NEAR(begin.y_m, end.y_m, 1e-9);
  EXPECT_NEAR(std::remainder(begin.heading_deg - end.heading_deg, 360.0), 0.0, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Worlds, ExampleWorld,
                         testing::Values("flat", "office", "corridor", "hall", "people"),
                         [](const auto& case_) { return std::string(case_.param); });

TEST(Office, ThePathIsAbout60Metres) {
  const std::vector<sim::path_point> path = example("office").path;
  double way = 0.0;
  double most_deg_per_s = 0.0;
  double most_m_per_s = 0.0;
  sim::pose last = path.front().robot.at;
  for (std::int64_t now = 0; now <= path.back().time_ns; now += 1'000'000) {
    const auto [at, per_s] = sim::robot_at(path, now);
    way += std::hypot(at.x_m - last.x_m, at.y_m - last.y_m);
    most_deg_per_s = std::max(most_deg_per_s, std::fabs(per_s.heading_deg));
    most_m_per_s = std::max(most_m_per_s, std::hypot(per_s.x_m, per_s.y_m));
    last = at;
  }
  EXPECT_NEAR(way, 60.0, 3.0);
  EXPECT_NEAR(most_deg_per_s, 90.0, 0.1);
  EXPECT_NEAR(most_m_per_s, 1.0, 0.001);
}

// Discs around a lidar: very near ones, ones that touch the beam, and one that the lidar is in.
TEST(Discs, TheFirstOneIsSeenFromAnywhere) {
  sim::random_stream random(5);
  const auto between = [&](double low, double high) {
    return low + (high - low) * random.uniform();
  };
  for (int round = 0; round < test::scaled(60); ++round) {
    sim::world world;
    world.lidar = {between(-3.0, 3.0), between(-3.0, 3.0), between(-360.0, 360.0)};
    for (int i = 0; i < 6; ++i) {
      const double radius = between(0.01, 2.0);
      const double away = radius + 0.12 + between(0.0, 6.0) * random.uniform();
      const double direction = between(0.0, 360.0) * radian;
      world.discs.push_back({radius, world.lidar.x_m + away * std::cos(direction),
                             world.lidar.y_m + away * std::sin(direction)});
      if (i % 2 == 0) continue;
      world.discs.back().to_x_m = world.discs.back().x_m + away * std::sin(direction);
      world.discs.back().to_y_m = world.discs.back().y_m - away * std::cos(direction);
      world.discs.back().speed_m_per_s = between(0.0, 0.01);
    }
    sim::scanner_options options;
    options.seed = static_cast<std::uint64_t>(round);
    sim::scanner scanner(world, options);
    for (int i = 0; i < 40; ++i) {
      for (const sim::sample_truth& truth : scanner.next().samples) {
        if (truth.index % 7 == 0) check(world, truth);
        if (testing::Test::HasFailure()) return;
      }
    }
  }
}

TEST(Discs, FromWithinTheFarSideIsSeen) {
  sim::world world;
  world.discs.push_back({2.0, 0.5, -0.7});
  sim::scanner scanner(world, {});
  for (int i = 0; i < 40; ++i) {
    for (const sim::sample_truth& truth : scanner.next().samples) {
      const double direction = -truth.bearing_deg * radian;
      const double x = truth.range_mm / 1000.0 * std::cos(direction) - 0.5;
      const double y = truth.range_mm / 1000.0 * std::sin(direction) + 0.7;
      ASSERT_NEAR(std::hypot(x, y), 2.0, 1e-9);
    }
  }
}

// Counter-clockwise, the lidar sees what it would see in a mirrored world.
TEST(Discs, AMirroredWorldMirrorsThemAndThePath) {
  sim::world world = parsed(
      "wall -4 -3 6 -2\nwall 6 -2 5 3\nwall 5 3 -4 2\nwall -4 2 -4 -3\ndisc 0.3 2 -1\n"
      "disc 0.25 -3 1 4 1.5 1.3\nlidar 0 0 20\ndrive arc 1.5 90\n");
  sim::world mirrored = world;
  for (sim::wall& w : mirrored.walls) w = {w.x1_m, -w.y1_m, w.x2_m, -w.y2_m};
  for (sim::disc& d : mirrored.discs) {
    d.y_m = -d.y_m;
    d.to_y_m = -d.to_y_m;
  }
  for (sim::path_point& point : mirrored.path) {
    for (sim::pose* each : {&point.robot.at, &point.robot.per_s}) {
      *each = {each->x_m, -each->y_m, -each->heading_deg};
    }
  }
  for (const bool drives : {true, false}) {
    if (!drives) {
      world.path.clear();
      mirrored.path.clear();
      mirrored.lidar.heading_deg = -world.lidar.heading_deg;
    }
    sim::scanner one(world, {});
    sim::scanner other(mirrored, {});
    one.set_turning(sim::turning::mirrored);
    for (int i = 0; i < 500; ++i) {
      const sim::sent_packet expected = other.next();
      const sim::sent_packet packet = one.next();
      for (std::size_t k = 0; k < packet.samples.size(); ++k) {
        ASSERT_NEAR(packet.samples[k].range_mm, expected.samples[k].range_mm, 1e-6);
      }
    }
  }
}

TEST(Mount, TheLidarIsWhereItIsMountedOnTheRobot) {
  const std::string walls = "wall -5 4 7 4\nwall -5 -4 7 -4\n";
  const sim::world world =
      parsed(walls + "lidar 0 0 90\nmount 0.3,-0.1,0\ndrive turn 90\ndrive forward 2\n");
  sim::scanner scanner(world, {});
  const sim::pose first = scanner.next().samples.front().lidar;
  EXPECT_NEAR(first.x_m, 0.1, 1e-12);
  EXPECT_NEAR(first.y_m, 0.3, 1e-12);
  EXPECT_NEAR(first.heading_deg, 270.0, 1e-12);
  sim::pose last;
  for (std::int64_t now = 0; now < world.path.back().time_ns + 1'000'000;) {
    const sim::sent_packet packet = scanner.next();
    now = packet.complete_ns;
    last = packet.samples.back().lidar;
    check(world, packet.samples.back());
  }
  EXPECT_NEAR(last.x_m, -2.3, 1e-9);
  EXPECT_NEAR(last.y_m, 0.1, 1e-9);
  EXPECT_NEAR(last.heading_deg, 360.0, 1e-9);
}

}  // namespace
