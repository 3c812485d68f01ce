// SPDX-License-Identifier: MIT
// The stage returns: a lidar that sees nothing, sectors from which nothing returns, and no false alarm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <variant>
#include <vector>

#include "diagnostics/doctor_bench.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/sim/device_options.hpp"
#include "g4lidar/sim/ray_caster.hpp"
#include "g4lidar/sim/setup.hpp"
#include "g4lidar/sim/world.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

sim::world world_of(std::string_view text) {
  const auto read = sim::parse_world(text);
  const auto* const made = std::get_if<sim::world>(&read);
  EXPECT_NE(made, nullptr) << text;
  return made != nullptr ? *made : sim::built_in_world();
}

examined examine_in(const sim::world& scene, const sim::device_options& options,
                    diagnostic_options how) {
  sim::device simulated(scene, options);
  sim::virtual_clock clock;
  return examine(simulated, clock, std::move(how));
}

/// The values of this name, one of each sector.
std::vector<int> degrees_of(const stage_report& report, std::string_view name) {
  std::vector<int> all;
  for (const evidence& each : report.measurements) {
    if (each.name == name) all.push_back(std::atoi(each.text().c_str()));
  }
  return all;
}

constexpr std::string_view far_away = "wall -900 900 900 900\nlidar 0 0 0\n";

TEST(Returns, NoneAtAllIsAWarning_OfEachModel) {
  for (const model& which : models) {
    sim::device_options options;
    ASSERT_TRUE(sim::use_model(options, which.word));
    diagnostic_options how{.model = &which};
    how.measuring_time = std::chrono::seconds(2);
    const examined done = examine_in(world_of(far_away), options, how);
    EXPECT_EQ(done.diagnoses(), "no_returns") << which.word << done;
    EXPECT_EQ(done.at(diagnostic_stage::returns).outcome, stage_verdict::warn) << which.word;
  }
}

// A wall at x = 2 m, from y = -20 to 20 m: directions from -84 to 84 degrees, counter-clockwise from straight ahead.
// At 16 m, the longest range of a G4, the wall ends for it: at 82.8 degrees.
TEST(Returns, ASectorIsNoFault) {
  const sim::world scene = world_of("wall 2 -20 2 20\nlidar 0 0 0\n");
  diagnostic_options how;
  how.measuring_time = std::chrono::seconds(2);
  how.directions.in = frame::robot;
  const examined done = examine_in(scene, {}, how);
  const stage_report& report = done.at(diagnostic_stage::returns);
  EXPECT_EQ(done.diagnoses(), "") << done;
  EXPECT_EQ(report.outcome, stage_verdict::ok);
  EXPECT_THAT(report.remark, HasSubstr("Nothing returned in "));
  const auto from = degrees_of(report, "nothing_from_deg");
  const auto to = degrees_of(report, "nothing_to_deg");
  ASSERT_EQ(from.size(), 1U) << done;
  ASSERT_EQ(to.size(), 1U);
  // The frame of the simulated lidar is the device's, turned by 180 degrees and mirrored.
  const int width = (to[0] - from[0] + 360) % 360;
  EXPECT_NEAR(width, 360 - 2 * 82.8, 6.0) << done;

  const std::array<sector, 1> ignored{sector(from[0], to[0])};
  how.directions.ignored_sectors = ignored;
  EXPECT_THAT(examine_in(scene, {}, how).at(diagnostic_stage::returns).remark, IsEmpty());
  how.directions.ignored_sectors = {};
  how.directions.field_of_view = sector(to[0] + 3, from[0] - 3);
  EXPECT_THAT(examine_in(scene, {}, how).at(diagnostic_stage::returns).remark, IsEmpty());
}

std::vector<sim::world> worlds() {
  std::vector<sim::world> all{sim::built_in_world()};
  for (const auto& file :
       std::filesystem::directory_iterator(std::string(G4LIDAR_SOURCE_DIR) + "/examples/worlds")) {
    const auto read = sim::load_world(file.path().string());
    if (const auto* const made = std::get_if<sim::world>(&read)) all.push_back(*made);
  }
  return all;
}

/// Whether a target within the range of the device is on a beam that ends in this sector, by the ray caster. Clockwise,
/// in the frame of the device.
bool has_target(const sim::world& scene, const sim::device_options& options, double from_deg,
                double to_deg) {
  const sim::ray_caster rays(scene, options.scanner.format.beam);
  for (double first_deg = 0.0; first_deg < 360.0; first_deg += 0.1) {
    const auto seen = rays.cast(first_deg);
    if (!seen || seen->range_mm < options.scanner.min_range_mm ||
        seen->range_mm > options.scanner.max_range_mm)
      continue;
    const double behind = std::fmod(seen->bearing_deg - from_deg + 720.0, 360.0);
    if (behind < std::fmod(to_deg - from_deg + 720.0, 360.0)) return true;
  }
  return false;
}

// In the nightly 1,000 runs and more.
TEST(Returns, NoFalseAlarmInAnyWorld) {
  const auto all = worlds();
  ASSERT_EQ(all.size(), 6U);
  std::size_t run = 0;
  for (const int seed : test::seeds(2)) {
    for (const model& which : models) {
      const sim::world& scene = all[run++ % all.size()];
      sim::device_options options;
      ASSERT_TRUE(sim::use_model(options, which.word));
      options.scanner.seed = static_cast<std::uint64_t>(seed);
      diagnostic_options how{.model = &which};
      how.measuring_time = std::chrono::seconds(3);
      const examined done = examine_in(scene, options, how);
      EXPECT_EQ(done.diagnoses().find("no_returns"), std::string::npos) << which.word << done;
      const stage_report& report = done.at(diagnostic_stage::returns);
      const auto from = degrees_of(report, "nothing_from_deg");
      const auto to = degrees_of(report, "nothing_to_deg");
      // Where it drives, the sectors are not those of one place.
      for (std::size_t i = 0; i < from.size() && scene.path.empty(); ++i) {
        EXPECT_FALSE(has_target(scene, options, from[i] + 1, to[i] - 1))
            << which.word << run << done;
      }
    }
  }
}

/// The directions of all returns, decoded independently of this project.
std::vector<double> returns_in(const std::filesystem::path& table) {
  std::ifstream file(table);
  std::vector<double> all;
  std::string line;
  std::getline(file, line);  // the header
  while (std::getline(file, line)) {
    double range_mm = 0.0;
    double angle_deg = 0.0;
    EXPECT_EQ(std::sscanf(line.c_str(), "%*u,%*u,%*u,%*u,%*u,%lf,%*f,%lf", &range_mm, &angle_deg),
              2);
    if (range_mm > 0.0) all.push_back(angle_deg);
  }
  return all;
}

TEST(Returns, NoFalseAlarmInBytesOfARealX4) {
  const std::filesystem::path captures = G4LIDAR_SOURCE_DIR "/../shared/captures";
  if (!std::filesystem::exists(captures)) {
    GTEST_SKIP() << "The recorded bytes are not at hand: there is no directory shared/captures "
                    "beside the project. They belong to third parties and are not part of it.";
  }
  for (const std::string name : {"x4_scan1", "x4_stream"}) {
    const auto directions = returns_in(captures / (name + ".points.csv"));
    ASSERT_GT(directions.size(), 100U);
    examined done;
    done.stages =
        diagnose("file:" + (captures / (name + ".bin")).string(), {.model = model_named("x4")});
    EXPECT_EQ(done.diagnoses().find("no_returns"), std::string::npos) << done;
    const stage_report& report = done.at(diagnostic_stage::returns);
    EXPECT_EQ(report.outcome == stage_verdict::ok, name == "x4_scan1") << "the other is too short";
    const auto from = degrees_of(report, "nothing_from_deg");
    const auto to = degrees_of(report, "nothing_to_deg");
    for (std::size_t i = 0; i < from.size(); ++i) {
      const double width = std::fmod(to[i] - from[i] + 359.0, 360.0) + 1.0;  // or a whole turn
      for (const double each : directions)
        EXPECT_GE(std::fmod(each - from[i] + 720.0, 360.0), width) << each << done;
    }
  }
}

}  // namespace
