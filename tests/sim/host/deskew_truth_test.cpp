// SPDX-License-Identifier: MIT
// Deskewed points of a lidar that drives through the worlds of examples/worlds, compared with the
// truth of the simulator.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/motion/deskew.hpp"
#include "g4lidar/motion/twist_estimator.hpp"
#include "g4lidar/sim/odometry.hpp"
#include "g4lidar/sim/scanner.hpp"
#include "motion/twist_errors.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4lidar;

/// About that of a G4.
constexpr sim::scanner_options noisy{.noise_mm = 4.0, .noise_ratio = 0.003, .dropout_ratio = 0.01};

struct revolution {
  std::vector<point> points;
  std::vector<sim::sample_truth> truth;
};

/// The decoded revolutions of a scanner.
class revolutions {
 public:
  explicit revolutions(const sim::world& world, const sim::scanner_options& options)
      : scanner_(world, options) {}

  /// The next revolution is the first whole one after that time, unless it has passed.
  void skip_to(std::int64_t time_ns) {
    if (time_ns <= scanner_.next_sample_ns()) return;
    scanner_.resume(time_ns, 0);
    (void)next();
  }
  revolution next() {
    revolution made = std::exchange(begun_, {});
    while (begun_.points.empty()) {
      const sim::sent_packet sent = scanner_.next();
      const packet_view packet = *packet_view::from(sent.data);
      revolution& to = packet.is_zero() ? begun_ : made;
      std::array<point, max_samples> memory;
      std::size_t i = 0;
      for (point p : decode(packet, exact_correction{}, 0, memory).points) {
        p.time_ns = sent.samples[i++].time_ns;
        to.points.push_back(p);
      }
      to.truth.insert(to.truth.end(), sent.samples.begin(), sent.samples.end());
    }
    return made;
  }

 private:
  sim::scanner scanner_;
  revolution begun_;
};

/// A pose of the simulator, where angle 0 of the lidar is the direction of its cable, as a pose of a
/// frame whose x axis is turned by `turned_deg` from there.
pose_2d pose_of(const sim::pose& at, double turned_deg) {
  return {at.x_m, at.y_m, (at.heading_deg + turned_deg) * test::degree};
}

/// The distance of each return from where its target would be seen at the reference time, in mm.
void add_errors(const std::vector<point>& points, const std::vector<sim::sample_truth>& truth,
                const sim::pose& reference, std::vector<double>& errors_mm) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (truth[i].raw == 0) continue;
    const double direction = (truth[i].lidar.heading_deg - truth[i].bearing_deg) * test::degree;
    const double range_m = truth[i].range_mm * 1e-3;
    const test::place seen = test::moved(pose_of(reference, 180.0), test::own_place(points[i]));
    errors_mm.push_back(1e3 *
                        std::hypot(seen.x - truth[i].lidar.x_m - range_m * std::cos(direction),
                                   seen.y - truth[i].lidar.y_m - range_m * std::sin(direction)));
  }
}

/// Errors of all returns, over the revolutions in which the robot moved.
struct errors {
  int moved = 0;
  int known = 0;  ///< Of these: the estimator knew the twist.
  std::vector<double> as_measured;
  std::vector<double> by_truth;
  std::vector<double> by_odometry;
  std::vector<double> as_measured_if_known;
  std::vector<double> by_estimate;
};

double median(const std::vector<double>& all) { return test::percentile(all, 50); }
double most(const std::vector<double>& all) { return test::percentile(all, 95); }

/// Over the whole path, in pieces of five revolutions.
errors drive(const sim::world& world, const sim::scanner_options& options) {
  const std::int64_t end_ns = world.path.back().time_ns;
  const mounting mount{pose_of(world.mounted_at, 0.0)};
  const auto truth = [&](std::int64_t now) {
    return pose_of(sim::robot_at(world.path, now).at, 0.0);
  };
  std::vector<stamped_pose> counted;
  sim::odometry odometry(world, {});
  while (counted.empty() || counted.back().time_ns < end_ns + 2'000'000'000) {
    const sim::odometry_sample s = odometry.next();
    counted.push_back({s.time_ns, {s.x_m, s.y_m, s.yaw_rad}});
  }
  errors made;
  revolutions lidar(world, options);
  const int pieces = test::scaled(16);
  for (int piece = 0; piece < pieces; ++piece) {
    lidar.skip_to(end_ns / pieces * piece);
    twist_estimator estimator;
    (void)estimator.add(lidar.next().points);
    for (int i = 0; i < 4; ++i) {
      const auto [points, samples] = lidar.next();
      const twist_estimate estimate = estimator.add(points);
      const sim::sample_truth& first = samples.front();
      if (first.time_ns > end_ns) return made;
      if (std::hypot(samples.back().lidar.x_m - first.lidar.x_m,
                     samples.back().lidar.y_m - first.lidar.y_m) < 0.01 &&
          std::fabs(samples.back().lidar.heading_deg - first.lidar.heading_deg) < 1.0) {
        continue;
      }
      ++made.moved;
      std::vector<point> out(points.size());
      const auto add = [&](const auto& motion, const mounting& at, std::vector<double>& to) {
        EXPECT_EQ(deskew(points, motion, first.time_ns, out, at).outside, 0U);
        add_errors(out, samples, first.lidar, to);
      };
      add_errors(points, samples, first.lidar, made.as_measured);
      add(truth, mount, made.by_truth);
      add(counted, mount, made.by_odometry);
      if (!estimate.is_known()) continue;
      ++made.known;
      add_errors(points, samples, first.lidar, made.as_measured_if_known);
      add(estimate.twist, {}, made.by_estimate);
    }
  }
  return made;
}

void print(const std::string& what, const errors& e) {
  std::printf(
      "%s: error in mm, median and 95th percentile, of %d revolutions: as measured %.1f %.1f, "
      "deskewed by the true path %.1f %.1f, by odometry %.1f %.1f; of the %d whose twist was "
      "estimated: as measured %.1f %.1f, deskewed %.1f %.1f\n",
      what.c_str(), e.moved, median(e.as_measured), most(e.as_measured), median(e.by_truth),
      most(e.by_truth), median(e.by_odometry), most(e.by_odometry), e.known,
      median(e.as_measured_if_known), most(e.as_measured_if_known), median(e.by_estimate),
      most(e.by_estimate));
}

void expect_half(const std::vector<double>& deskewed, const std::vector<double>& as_measured) {
  EXPECT_LT(median(deskewed), 0.5 * median(as_measured));
  EXPECT_LT(most(deskewed), 0.5 * most(as_measured));
}

sim::world example(const std::string& name) {
  std::ifstream in(G4LIDAR_SOURCE_DIR "/examples/worlds/" + name + ".txt");
  return std::get<sim::world>(sim::parse_world(std::string(std::istreambuf_iterator(in), {})));
}

class DeskewedInWorld : public testing::TestWithParam<const char*> {};

TEST_P(DeskewedInWorld, PointsAreWithinAFewMillimetresOfTheTruth) {
  const errors e = drive(example(GetParam()), {});
  ASSERT_GT(e.known, 0.6 * e.moved);
  print(GetParam(), e);
  EXPECT_LT(most(e.by_truth), 3.0);
  EXPECT_LT(most(e.by_odometry), 3.0);
  expect_half(e.by_estimate, e.as_measured_if_known);
}

TEST_P(DeskewedInWorld, WithNoiseTheErrorIsAtMostHalf) {
  const errors e = drive(example(GetParam()), noisy);
  ASSERT_GT(e.known, 0.6 * e.moved);
  print(std::string(GetParam()) + ", with noise", e);
  expect_half(e.by_truth, e.as_measured);
  expect_half(e.by_odometry, e.as_measured);
  expect_half(e.by_estimate, e.as_measured_if_known);
}

INSTANTIATE_TEST_SUITE_P(Worlds, DeskewedInWorld,
                         testing::Values("flat", "office", "corridor", "hall", "people"),
                         [](const auto& case_) { return std::string(case_.param); });

// The place of a lidar on the robot is the same in a world and for deskew().
TEST(DeskewedByItsMounting, IsTheSameInAWorldAndForDeskew) {
  sim::world world = example("office");
  world.mounted_at = {0.3, -0.2, 60.0};
  world.path = std::get<std::vector<sim::path_point>>(
      sim::parse_path("drive forward 4 0.8\ndrive turn 360 60\n", world.lidar));
  const errors e = drive(world, {});
  ASSERT_GT(e.moved, 10);
  EXPECT_LT(most(e.by_truth), 3.0);
  EXPECT_GT(most(e.as_measured), 30.0);
}

TEST(DeskewedAt90DegreesPerSecond, TheErrorIsAtMostHalf) {
  sim::world world = example("office");
  world.path =
      std::get<std::vector<sim::path_point>>(sim::parse_path("drive turn 3600 90\n", world.lidar));
  const errors e = drive(world, noisy);
  ASSERT_GT(e.known, 0.9 * e.moved);
  print("office, turning at 90 degrees per second, with noise", e);
  expect_half(e.by_truth, e.as_measured);
  expect_half(e.by_odometry, e.as_measured);
  expect_half(e.by_estimate, e.as_measured_if_known);
}

}  // namespace
