// SPDX-License-Identifier: MIT
// Which directions without return mark_near() flags: rules on single points, and its false alarms and
// misses before approaching walls, poles and people in the simulator, by the simulator's true ranges.
#include "g4lidar/filter/too_near.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/sim/scanner.hpp"
#include "g4lidar/sim/world.hpp"
#include "support/allocation_count.hpp"

namespace g4lidar::test {
namespace {

/// A point of the beam at this angle of the head, as the formula of the manual places it.
point on_beam(double head_deg, double range_mm, std::uint32_t revolution) {
  const double far = range_mm == 0.0 ? 1e15 : range_mm;
  const double turn_rad = std::atan(21.8 / far - 21.8 / 155.3);
  point p;
  p.angle_deg = wrap_deg(static_cast<float>(head_deg + turn_rad * 57.29577951308232));
  p.range_mm = static_cast<float>(range_mm);
  p.revolution = revolution;
  if (range_mm == 0.0) p.flags = point_flags::no_return;
  return p;
}

/// One point of a beam for each revolution: its number is its revolution. Returns which are flagged.
std::string flagged(const std::vector<double>& ranges_mm, const near_limits& limits = {}) {
  near_history history;
  std::string found;
  std::uint32_t revolution = 0;
  for (const double range_mm : ranges_mm) {
    std::array<point, 1> one{on_beam(100.5, range_mm, revolution++)};
    const std::size_t count = mark_near(one, history, limits);
    EXPECT_EQ(count == 1, one[0].may_be_too_near());
    found += one[0].may_be_too_near() ? 'x' : '.';
  }
  return found;
}

TEST(MarkNear, NoReturnAfterANearReturn_IsFlaggedForThreeRevolutions) {
  EXPECT_EQ(flagged({900, 500, 300, 0, 0, 0, 0, 0}), "...xxx..");
  EXPECT_EQ(flagged({559, 0, 0, 559, 0, 0, 0, 0}), ".xx.xxx.");
  EXPECT_EQ(flagged({60, 0}), ".x") << "what is below 100 mm is a near return, too";
}

TEST(MarkNear, NoReturnWithoutANearReturnBefore_IsNotFlagged) {
  EXPECT_EQ(flagged({0, 0, 0}), "...");
  EXPECT_EQ(flagged({560, 0, 0}), "...") << "twice the shortest range is not near";
  EXPECT_EQ(flagged({300, 2000, 0, 0}), "....") << "a farther return came since";
}

TEST(MarkNear, Limits_AreTheShortestRangeAndTheRevolutions) {
  EXPECT_EQ(flagged({300, 0}, {.shortest_mm = 100.0F}), "..");
  EXPECT_EQ(flagged({190, 0}, {.shortest_mm = 100.0F}), ".x");
  EXPECT_EQ(flagged({300, 0, 0, 0}, {.revolutions = 1}), ".x..");
  const std::vector<double> stays{300, 0, 0, 0, 0, 0, 0, 0, 0, 2000, 0};
  EXPECT_EQ(flagged(stays, {.revolutions = near_limits::until_return}), ".xxxxxxxx..");
}

// The directions of both differ by 4 degrees; the beam is the same.
TEST(MarkNear, ComparesBeams_NotCorrectedDirections) {
  near_history history;
  std::vector<point> points;
  for (int head = 50; head < 90; ++head) points.push_back(on_beam(head + 0.5, 300, 0));
  for (int head = 40; head < 100; ++head) points.push_back(on_beam(head + 0.5, 0, 1));
  EXPECT_EQ(mark_near(points, history), 40U);
  for (std::size_t i = 0; i < 60; ++i) {
    EXPECT_EQ(points[40 + i].may_be_too_near(), i >= 10 && i < 50) << i;
  }
}

// A T-mini has no correction: the directions of its points are those of its beams.
TEST(MarkNear, TheBeamsAreThoseOfTheModel) {
  const auto count_of = [](const char* model) {
    std::vector<point> points(2);
    points[0].angle_deg = points[1].angle_deg = 100.5F;
    points[0].range_mm = 300.0F;
    points[1].revolution = 1;
    points[1].flags = point_flags::no_return;
    near_history history;
    return mark_near(points, history, {.shortest_mm = 280.0F}, *model_named(model));
  };
  EXPECT_EQ(count_of("t-mini"), 1U);
  EXPECT_EQ(count_of("g4"), 0U) << "a G4 has measured them on two beams";
}

// The shortest range of a G4 at 9 kHz is 280 mm, of an X4 120 mm, of a T-mini Pro 20 mm.
TEST(MarkNear, TheShortestRangeIsThatOfTheModel) {
  const auto is_near = [](const char* model, float range_mm) {
    std::vector<point> points(2);
    points[0].range_mm = range_mm;
    points[1].revolution = 1;
    points[1].flags = point_flags::no_return;
    points[0].angle_deg = points[1].angle_deg = 100.5F;
    near_history history;
    return mark_near(points, history, {}, *model_named(model)) == 1;
  };
  EXPECT_TRUE(is_near("t-mini-pro", 39.0F));
  EXPECT_FALSE(is_near("t-mini-pro", 41.0F));
  EXPECT_TRUE(is_near("t-mini", 99.0F));
  EXPECT_FALSE(is_near("t-mini", 101.0F));
  EXPECT_EQ(near_limits{}.shortest_mm_of(g4_model), 280.0F);
  EXPECT_EQ(near_limits{}.shortest_mm_of(*model_named("x4")), 120.0F);
  EXPECT_EQ(near_limits{}.shortest_mm_of(*model_named("x4"), 5000), 120.0F);
  EXPECT_EQ(near_limits{.shortest_mm = 300.0F}.shortest_mm_of(*model_named("x4")), 300.0F);
}

// The data sheet of the G4: 280 mm at 9 kHz, 260 mm at 8 kHz, 100 mm at 4 kHz.
TEST(MarkNear, TheShortestRangeIsThatAtTheSampleRate) {
  EXPECT_EQ(near_limits{}.shortest_mm_of(g4_model, 9000), 280.0F);
  EXPECT_EQ(near_limits{}.shortest_mm_of(g4_model, 8000), 260.0F);
  EXPECT_EQ(near_limits{}.shortest_mm_of(g4_model, 4000), 100.0F);
  EXPECT_EQ(near_limits{}.shortest_mm_of(g4_model, 5000), 280.0F) << "it does not have this rate";
  EXPECT_EQ(near_limits{.shortest_mm = 300.0F}.shortest_mm_of(g4_model, 4000), 300.0F);
  const auto count_of = [](double range_mm, std::uint32_t rate_hz) {
    std::vector<point> points{on_beam(50.5, range_mm, 0), on_beam(50.5, 0, 1)};
    near_history history;
    return mark_near(points, history, {}, g4_model, rate_hz);
  };
  EXPECT_EQ(count_of(210, 9000), 1U);
  EXPECT_EQ(count_of(210, 4000), 0U) << "a target is seen up to 100 mm";
  EXPECT_EQ(count_of(190, 4000), 1U);
}

// None is at a whole degree, where rounding decides between two places.
TEST(MarkNear, EveryBeam_HasItsPlace) {
  for (double head = 0.005; head < 360.0; head += 0.37) {
    near_history history;
    std::array points{on_beam(head, 400, 0), on_beam(head, 0, 1)};
    EXPECT_EQ(mark_near(points, history), 1U) << head;
  }
}

TEST(MarkNear, ClearsTheFlagOnOthers_AndKeepsOtherFlags) {
  near_history history;
  std::vector<point> points{on_beam(10.5, 300, 0), on_beam(10.5, 0, 1), on_beam(20.5, 0, 1)};
  points[1].flags = points[1].flags | point_flags::revolution_start;
  points[2].flags = points[2].flags | point_flags::may_be_too_near;
  std::vector<point> out(4);
  EXPECT_EQ(mark_near(std::span<const point>(points), out, history), 1U);
  EXPECT_TRUE(points[2].may_be_too_near()) << "the copy is changed, not the points";
  EXPECT_TRUE(out[1].may_be_too_near());
  EXPECT_TRUE(out[1].is_no_return() && out[1].is_revolution_start());
  EXPECT_FALSE(out[2].may_be_too_near());
  history.reset();
  std::array after{on_beam(10.5, 0, 2)};
  EXPECT_EQ(mark_near(after, history), 0U);
}

TEST(MarkNear, ANewStream_ForgetsTheOldOne) {
  near_history history;
  std::array points{on_beam(10.5, 300, 70), on_beam(10.5, 0, 0), on_beam(10.5, 0, 71)};
  EXPECT_EQ(mark_near(points, history, {.revolutions = near_limits::until_return}), 0U);
}

TEST(MarkNear, NeverAllocates_AndHasTheStatedSize) {
  static_assert(sizeof(near_history) == 1440);
  std::vector<point> points{on_beam(10.5, 300, 0), on_beam(10.5, 0, 1)};
  EXPECT_EQ(allocations_in([&] {
              near_history history;
              static_cast<void>(mark_near(points, history));
            }),
            0U);
}

// ---- false alarms and misses ------------------------------------------------------------------

/// Samples without return, by what the simulator knows and what is flagged.
struct tally {
  std::size_t found = 0;         ///< The target is nearer than the shortest range: flagged,
  std::size_t missed = 0;        ///< and not flagged.
  std::size_t false_alarms = 0;  ///< There is no target, or it is farther: flagged,
  std::size_t rightly_not = 0;   ///< and not flagged.

  [[nodiscard]] double found_percent() const { return percent(found, missed); }
  [[nodiscard]] double false_percent() const { return percent(false_alarms, found); }

 private:
  static double percent(std::size_t part, std::size_t rest) {
    return 100.0 * static_cast<double>(part) / static_cast<double>(part + rest);
  }
};

/// 100 revolutions of a simulated G4 at 9 kHz and 7 Hz with noise and 1 % of the samples without
/// return for no reason.
tally run(std::string_view world, const near_limits& limits) {
  const auto read = sim::parse_world(world);
  EXPECT_TRUE(std::holds_alternative<sim::world>(read));
  if (!std::holds_alternative<sim::world>(read)) return {};
  sim::scanner lidar(std::get<sim::world>(read),
                     {.seed = 3, .noise_mm = 4.0, .noise_ratio = 0.003, .dropout_ratio = 0.01});
  near_history history;
  revolution_counter revolutions;
  std::array<point, max_samples> memory;
  tally all;
  for (std::uint32_t revolution = 0; revolution < 100;) {
    const sim::sent_packet sent = lidar.next();
    const auto packet = packet_view::from(sent.data);
    if (!packet) continue;
    revolution = revolutions.count(*packet);
    const std::size_t count =
        decode(*packet, compact_correction{}, revolution, memory).points.size();
    static_cast<void>(mark_near(std::span(memory).first(count), history, limits));
    for (std::size_t i = 0; i < count; ++i) {
      const sim::sample_truth& truth = sent.samples[i];
      EXPECT_EQ(memory[i].is_no_return(), truth.raw == 0);
      if (truth.raw != 0) {
        EXPECT_FALSE(memory[i].may_be_too_near());
        continue;
      }
      const bool is_near = truth.range_mm > 0.0 && truth.range_mm < 280.0;
      const bool is_flagged = memory[i].may_be_too_near();
      if (is_near) ++(is_flagged ? all.found : all.missed);
      if (!is_near) ++(is_flagged ? all.false_alarms : all.rightly_not);
    }
  }
  return all;
}

constexpr const char* room = R"(
wall -4 -3 4 -3
wall 4 -3 4 3
wall 4 3 -4 3
wall -4 3 -4 -3
)";

struct scene {
  const char* name;
  std::string world;
  /// Of the samples whose target is too near: flagged by default, and until a return comes.
  double found_percent;
  double found_until_percent;
  /// Of the flagged samples: those without a target that is too near.
  double false_percent;
  double false_until_percent;
};

const std::vector<scene>& scenes() {
  static const std::string here = room;
  static const std::vector<scene> all{
      // To 0.15 m before the wall, where it stands for 3 s, and back.
      {"wall",
       here + "lidar 2.8 0 0\ndrive wait 1\ndrive forward 1.05 0.3\ndrive wait 3\n"
              "drive forward -1.05 0.3\n",
       11, 100, 11, 2},
      // The same before a pole of 0.1 m.
      {"pole",
       here + "disc 0.05 1.2 0\nlidar 0 0 0\ndrive wait 1\ndrive forward 1 0.3\ndrive wait 3\n"
              "drive forward -1 0.3\n",
       7, 65, 5, 1},
      // Somebody comes to 0.2 m and leaves, again and again; another one passes at 0.2 m.
      {"people",
       here + "disc 0.25 -2 0.05 -0.45 0.05 0.8\ndisc 0.25 0.45 -2.5 0.45 2.5 1\nlidar 0 0 0\n", 68,
       68, 7, 7},
      // The same without walls: nothing is behind them.
      {"people, no walls",
       "wall 30 -1 30 1\ndisc 0.25 -2 0.05 -0.45 0.05 0.8\ndisc 0.25 0.45 -2.5 0.45 2.5 1\nlidar 0 "
       "0 0\n",
       69, 86, 66, 94},
  };
  return all;
}

TEST(MarkNear, FalseAlarmsAndMisses_AreAsStated) {
  for (const scene& each : scenes()) {
    SCOPED_TRACE(each.name);
    const tally few = run(each.world, {});
    const tally until = run(each.world, {.revolutions = near_limits::until_return});
    for (const tally& one : {few, until}) {
      std::printf(
          "%-17s %6zu found %6zu missed %6zu false %6zu rightly not: %5.1f %% found, %5.1f %% "
          "false\n",
          each.name, one.found, one.missed, one.false_alarms, one.rightly_not, one.found_percent(),
          one.false_percent());
    }
    // The docstring has these numbers.
    EXPECT_NEAR(few.found_percent(), each.found_percent, 0.7);
    EXPECT_NEAR(until.found_percent(), each.found_until_percent, 0.7);
    EXPECT_NEAR(few.false_percent(), each.false_percent, 0.7);
    EXPECT_NEAR(until.false_percent(), each.false_until_percent, 0.7);
  }
}

}  // namespace
}  // namespace g4lidar::test
