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
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/diagnostics/running_diagnosis.hpp"
#include "g4lidar/lidar.hpp"
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

/// The sectors of the options in a remark: "--ignore 227:313".
std::vector<std::pair<int, int>> options_in(const std::string& remark) {
  const std::string option = "--ignore ";
  std::vector<std::pair<int, int>> all;
  for (std::size_t at = remark.find(option); at != std::string::npos;
       at = remark.find(option, at + 1)) {
    int from = -1;
    int to = -1;
    EXPECT_EQ(std::sscanf(remark.c_str() + at, "--ignore %d:%d", &from, &to), 2) << remark;
    all.emplace_back(from, to);
  }
  return all;
}

struct blind_place {
  std::string_view walls;
  int count;  ///< Of sectors without a return.
};

// What is to be copied is the option of the same frame: with it nothing is reported any more. Of sectors in each direction, that
// cross 0, and of all but a narrow one.
TEST(Returns, TheLineToCopy_LeavesTheSectorOut) {
  for (const blind_place& place :
       {blind_place{"wall 2 -20 2 20", 1}, blind_place{"wall -2 -20 -2 20", 1},
        blind_place{"wall -20 2 20 2", 1}, blind_place{"wall -20 -2 20 -2", 1},
        blind_place{"wall 2 -0.2 2 0.2", 1}, blind_place{"wall -2 -0.2 -2 0.2", 1},
        blind_place{"wall 2 -2 2 2\nwall -2 -2 -2 2", 2}}) {
    const sim::world scene = world_of(std::string(place.walls) + "\nlidar 0 0 0\n");
    for (const char* const word : {"g4", "x4", "tg15"}) {
      for (const frame in : {frame::vendor, frame::robot}) {
        const model& which = *model_named(word);
        sim::device_options options;
        ASSERT_TRUE(sim::use_model(options, word));
        diagnostic_options how{.model = &which};
        how.measuring_time = std::chrono::seconds(2);
        how.directions.in = in;
        const examined done = examine_in(scene, options, how);
        const std::string remark = done.at(diagnostic_stage::returns).remark;
        EXPECT_THAT(remark, HasSubstr(in == frame::robot ? "counter-clockwise from ahead"
                                                         : ", clockwise from 0 of the lidar"));
        const auto found = options_in(remark);
        ASSERT_EQ(found.size(), static_cast<std::size_t>(place.count)) << place.walls << done;
        std::vector<sector> ignored;
        for (const auto& [from, to] : found) {
          EXPECT_TRUE(from >= 0 && from < 360 && to >= 0 && to < 360) << remark;
          ignored.emplace_back(from, to);
        }
        how.directions.ignored_sectors = ignored;
        EXPECT_THAT(examine_in(scene, options, how).at(diagnostic_stage::returns).remark, IsEmpty())
            << word << place.walls << remark;
        // A half of it: only the rest is reported.
        if (place.count != 1) continue;
        const int width = (found[0].second - found[0].first + 360) % 360;
        if (width > 300) continue;
        const std::array<sector, 1> half{sector(found[0].first, found[0].first + width / 2)};
        how.directions.ignored_sectors = half;
        const auto rest =
            options_in(examine_in(scene, options, how).at(diagnostic_stage::returns).remark);
        ASSERT_EQ(rest.size(), 1U);
        EXPECT_NEAR((rest[0].first - found[0].first + 360) % 360, width / 2 + 1, 2);
        EXPECT_NEAR((rest[0].second - found[0].second + 540) % 360, 180, 3);
      }
    }
  }
}

// Straight ahead is 0 in the robot's frame: a part of the robot behind it is around 180.
TEST(Returns, DegreesAreThoseOfTheFrame) {
  const sim::world scene = world_of("wall 2 -20 2 20\nlidar 0 0 0\n");
  sim::device_options options;
  diagnostic_options how;
  how.measuring_time = std::chrono::seconds(2);
  std::array<std::pair<int, int>, 2> seen{};
  for (const frame in : {frame::vendor, frame::robot}) {
    how.directions.in = in;
    const auto found =
        options_in(examine_in(scene, options, how).at(diagnostic_stage::returns).remark);
    ASSERT_EQ(found.size(), 1U);
    seen.at(in == frame::robot ? 1 : 0) = found[0];
  }
  // A G4: robot = 180 - vendor, and the sense is the other one.
  EXPECT_NEAR((180 - seen[0].second + 720) % 360, seen[1].first, 2);
  EXPECT_NEAR((180 - seen[0].first + 720) % 360, seen[1].second, 2);
}

// In /diagnostics and in the page, which have the stages of the running diagnosis.
TEST(Returns, RunningDiagnosis_HasTheSameText) {
  const sim::world scene = world_of("wall 2 -20 2 20\nlidar 0 0 0\n");
  sim::device simulated(scene, {});
  sim::virtual_clock clock;
  running_diagnosis judge;
  auto lidar =
      lidar::open(judge.observe(std::make_unique<sim::virtual_connector>(simulated, clock)));
  ASSERT_TRUE(lidar && lidar->start());
  while (clock.now_ns() < 30'000'000'000)
    static_cast<void>(lidar->try_scan(std::chrono::milliseconds(200)));
  const point_filter directions{.in = frame::robot};
  examined running;
  running.stages = judge.stages(directions);
  const std::string text = running.at(diagnostic_stage::returns).remark;
  diagnostic_options how;
  how.directions = directions;
  const std::string once = examine_in(scene, {}, how).at(diagnostic_stage::returns).remark;
  ASSERT_EQ(options_in(text).size(), 1U) << running;
  // The edges are measured: a degree more or less.
  const auto shape = [](std::string words) {
    std::erase_if(words, [](char each) { return each >= '0' && each <= '9'; });
    return words;
  };
  EXPECT_EQ(shape(text), shape(once));
  EXPECT_NEAR(options_in(text)[0].first, options_in(once)[0].first, 2);
  EXPECT_THAT(status_of(running.at(diagnostic_stage::returns), "").message, HasSubstr(text));
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
