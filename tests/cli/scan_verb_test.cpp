// SPDX-License-Identifier: MIT
// g4-dump scan on raw bytes: held against points that are worked out, filtered and turned here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "wanted_points.hpp"

namespace {

using namespace cli;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Scan, WholeRevolutionsOnly) {
  const outcome whole = run({"scan", "-", "-f", "csv"}, simulated());
  const outcome all = run({"scan", "-", "-f", "csv", "--partial"}, simulated());
  std::string expected;
  for (const std::string& line : lines_of(all.out)) {
    if (line.find(",true,") == std::string::npos) expected += line + "\n";
  }
  EXPECT_EQ(whole.out, expected);
  EXPECT_THAT(whole.err, HasSubstr("2 incomplete revolutions left out; --partial"));
  EXPECT_EQ(lines_of(run({"scan", "-", "-f", "csv", "-n", "3"}, simulated()).out).size(), 4U);
}

TEST(Scan, PointsAreShapedInEachFormat) {
  const std::vector<std::string> shape{"--frame", "robot", "--unit", "m", "--fov", "-45:45", "-q"};
  const auto with = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), shape.begin(), shape.end());
    return run(arguments, simulated()).out;
  };
  wanted_form wanted;
  wanted.fov_from = -45;
  wanted.fov_to = 45;
  const std::string csv = with({"scan", "-", "-f", "csv", "--partial"});
  std::vector<row> shown;
  std::size_t line = 1;
  for (const std::string& text : lines_of(with({"scan", "-", "-f", "jsonl", "--partial"}))) {
    const json scan = json::parse(text);
    EXPECT_THAT(lines_of(csv).at(line++),
                HasSubstr("," + std::to_string(scan.at("points").get<std::size_t>()) + ","));
    for (std::size_t i = 0; i < scan.at("angle_deg").size(); ++i) {
      shown.push_back({scan.at("scan"), scan.at("angle_deg").at(i), scan.at("range_m").at(i),
                       scan.at("time_ns").at(i)});
    }
  }
  expect_shown(shown, wanted_points(simulated(), true, wanted), 1000.0);
  // How fast it turned does not depend on which points are looked at.
  EXPECT_THAT(lines_of(csv).at(2), ::testing::EndsWith(",7.0,7.000"));
}

/// The ranges of bins that a row of csv has behind its first three fields.
std::vector<double> bins_of(const std::string& line) {
  std::vector<double> bins;
  std::istringstream fields(line);
  std::string field;
  for (int i = 0; std::getline(fields, field, ','); ++i) {
    if (i >= 3) bins.push_back(std::stod(field));
  }
  return bins;
}

TEST(Scan, AGridKnowsEmptyFromUnknown) {
  // 0.5 m at 0..89, nothing at 90..179, 0.05 m (too near) at 180..269, 3 m at 270..359; by the
  // direction in which the sensor looked.
  const auto raw_angle = [](double direction, double range_mm) {
    const double far = std::atan(-21.8 / 155.3);
    const double turn =
        range_mm == 0.0 ? far : std::atan(21.8 * (155.3 - range_mm) / (155.3 * range_mm));
    return std::fmod(direction - turn * degrees_of_radian + 360.0, 360.0);
  };
  std::string bytes = cli::zero(0, 2000);
  for (int direction = 0; direction < 360; direction += 2) {
    const double range_mm = direction < 90    ? 500
                            : direction < 180 ? 0
                            : direction < 270 ? 50
                                              : 3000;
    const double angle = raw_angle(direction, range_mm);
    bytes += cli::packet(angle, angle, {static_cast<std::uint16_t>(range_mm * 4)});
  }
  const std::vector<std::string> grid{"scan", "-", "--grid", "90", "-f", "csv", "-q", "--partial"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = grid;
    arguments.insert(arguments.end(), more.begin(), more.end());
    const std::vector<std::string> lines = lines_of(run(arguments, bytes).out);
    EXPECT_THAT(lines.at(0), StartsWith("scan,time_ns,partial,range_"));
    // A scan goes once round by its angles, and the corrections make these of several revolutions.
    std::vector<double> merged(90, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 1; i < lines.size(); ++i) {
      const std::vector<double> bins = bins_of(lines[i]);
      EXPECT_EQ(bins.size(), 90U);
      for (std::size_t k = 0; k < bins.size(); ++k) {
        if (!std::isnan(bins[k])) merged[k] = bins[k];
      }
    }
    return merged;
  };
  const auto expect_bins = [](const std::vector<double>& bins, double from_deg, double to_deg,
                              double value) {
    for (int k = 0; k < 90; ++k) {
      const double middle = k * 4.0;
      if (middle < from_deg + 5 || middle > to_deg - 6) continue;
      const double bin = bins[static_cast<std::size_t>(k)];
      if (std::isnan(value)) {
        EXPECT_TRUE(std::isnan(bin)) << middle << " has " << bin;
      } else {
        EXPECT_EQ(bin, value) << middle;
      }
    }
  };
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  constexpr double nothing = std::numeric_limits<double>::infinity();
  const std::vector<double> plain = with({});
  expect_bins(plain, 0, 90, 500);
  expect_bins(plain, 90, 180, nothing);
  expect_bins(plain, 180, 270, unknown);
  expect_bins(plain, 270, 360, 3000);
  const std::vector<double> far = with({"--range", "1:16"});
  expect_bins(far, 0, 90, unknown);
  expect_bins(far, 90, 180, nothing);
  expect_bins(far, 270, 360, 3000);
  const std::vector<double> near = with({"--range", "0.01:16"});
  expect_bins(near, 180, 270, 50);
  const std::vector<double> sides = with({"--fov", "270:90", "--unit", "m"});
  expect_bins(sides, 0, 90, 0.5);
  expect_bins(sides, 90, 180, unknown);
  expect_bins(sides, 180, 270, unknown);
  expect_bins(sides, 270, 360, 3);
  // In the robot's frame bin 0 is behind it: 0 degrees of the vendor's.
  std::vector<double> robot = with({"--frame", "robot", "--fov", "-180:0"});
  std::reverse(robot.begin() + 1, robot.end());
  expect_bins(robot, 0, 180, unknown);
  robot = with({"--frame", "robot", "--fov", "-180:0"});
  expect_bins(robot, 0, 90, 3000);  // -180 to -90: the vendor's 360 to 270
}

TEST(Scan, GridsInOtherFormats) {
  const std::string bytes = cli::zero(0) + cli::turn() + cli::zero(0);
  const json grid = json::parse(
      run({"scan", "-", "--grid", "4", "-f", "jsonl", "--fov", "80:100", "-q"}, bytes).out);
  EXPECT_EQ(grid.at("angle_min_deg"), 0);
  EXPECT_EQ(grid.at("angle_step_deg"), 90);
  EXPECT_EQ(grid.at("ranges_mm"), json::parse("[null,1000.0,null,null]"));
  EXPECT_EQ(run({"scan", "-", "--grid", "3", "--unit", "m", "-q"}, bytes).out,
            "  scan  3 ranges in m\n     0  1.00000 1.00000 1.00000\n");
  EXPECT_EQ(run({"scan", "-", "--grid", "0"}, bytes).code, 2);
  EXPECT_EQ(run({"scan", "-", "--grid", "3", "-f", "pcd"}, bytes).code, 2);
}

class Pcd : public cli::scratch {};

TEST_F(Pcd, AFileForEachRevolution) {
  EXPECT_EQ(
      run({"scan", "-", "-f", "pcd", "-n", "3", "-o", path("s%03d.pcd"), "-q"}, simulated()).code,
      0);
  EXPECT_EQ(listing(), "s000.pcd\ns001.pcd\ns002.pcd\n");
  EXPECT_NE(cli::read_file(path("s000.pcd")), cli::read_file(path("s001.pcd")));
  std::filesystem::create_directory(path("d"));
  EXPECT_EQ(run({"scan", "-", "-f", "pcd", "-n", "2", "-o", path("d"), "-q"}, simulated()).code, 0);
  EXPECT_TRUE(std::filesystem::exists(path("d/scan-000001.pcd")));
  EXPECT_FALSE(std::filesystem::exists(path("d/scan-000002.pcd")));
  EXPECT_EQ(run({"scan", "-", "-f", "pcd", "-o", path("one.pcd"), "-q"}, simulated()).code, 0);
  EXPECT_EQ(cli::read_file(path("one.pcd")), cli::read_file(path("s000.pcd")));
  for (const char* const name : {"s%s.pcd", "s%3d.pcd", "s%d-%d.pcd", "s%"}) {
    EXPECT_EQ(run({"scan", "-", "-f", "pcd", "-o", path(name)}, simulated()).code, 2) << name;
  }
  EXPECT_EQ(run({"scan", "-", "-f", "pcd", "-n", "2", "-o", path("two.pcd")}, simulated()).code, 2);
  EXPECT_EQ(run({"scan", "-", "-f", "pcd", "-n", "2", "-o", path("none/%d.pcd")}, simulated()).code,
            10);
  EXPECT_EQ(run({"dump", "-", "-f", "pcd"}, simulated()).code, 2);
}

}  // namespace
