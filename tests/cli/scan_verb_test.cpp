// SPDX-License-Identifier: MIT
// g4-dump scan on raw bytes: held against points that are worked out, filtered and turned here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
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

class Pcd : public cli::scratch {
 protected:
  /// The lines of the header, by their first word.
  static std::string field(const std::string& file, const std::string& name) {
    for (const std::string& line : lines_of(file)) {
      if (line.starts_with(name + " ")) return line.substr(name.size() + 1);
      if (line.starts_with("DATA")) break;
    }
    return "";
  }
};

TEST_F(Pcd, BinaryAndAsciiHoldTheReturns) {
  const std::vector<std::string> shape{"--frame", "robot", "--range", "0.1:16", "-q"};
  const auto with = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), shape.begin(), shape.end());
    return run(arguments, simulated()).out;
  };
  const std::string binary = with({"scan", "-", "-f", "pcd"});
  const std::string ascii = with({"scan", "-", "-f", "pcd", "--pcd-data", "ascii"});
  EXPECT_EQ(field(binary, "VERSION"), "0.7");
  EXPECT_EQ(field(binary, "FIELDS"), "x y z range_m angle_deg time_ns");
  EXPECT_EQ(field(binary, "SIZE"), "4 4 4 4 4 8");
  EXPECT_EQ(field(binary, "TYPE"), "F F F F F I");
  EXPECT_EQ(field(binary, "DATA"), "binary");
  EXPECT_EQ(field(ascii, "DATA"), "ascii");
  EXPECT_EQ(field(binary, "WIDTH"), field(binary, "POINTS"));
  const std::size_t count = std::stoul(field(binary, "POINTS"));
  const std::string data = binary.substr(binary.find("DATA binary\n") + 12);
  ASSERT_EQ(data.size(), count * 28);
  wanted_form wanted;  // of revolution 1, the first one that is whole
  wanted.range_from_mm = 100;
  wanted.range_to_mm = 16'000;
  std::vector<wanted_point> points = wanted_points(simulated(), true, wanted);
  std::erase_if(points, [](const wanted_point& p) { return p.scan != 1; });
  ASSERT_EQ(points.size(), count);
  std::istringstream text(ascii.substr(ascii.find("DATA ascii\n") + 11));
  for (std::size_t i = 0; i < count; ++i) {
    float fields[5];
    std::int64_t time_ns = 0;
    std::memcpy(fields, &data[i * 28], 20);
    std::memcpy(&time_ns, &data[i * 28 + 20], 8);
    double x = 0, y = 0, z = 0, range_m = 0, angle_deg = 0;
    std::int64_t text_ns = 0;
    text >> x >> y >> z >> range_m >> angle_deg >> text_ns;
    const double bearing = points[i].angle_deg / degrees_of_radian;
    const double range = points[i].range_mm / 1000.0;
    ASSERT_NEAR(fields[0], range * std::cos(bearing), 5e-5);
    ASSERT_NEAR(fields[1], range * std::sin(bearing), 5e-5);
    ASSERT_EQ(fields[2], 0.0F);
    ASSERT_NEAR(fields[3], range, 1e-6);
    ASSERT_NEAR(fields[4], points[i].angle_deg, 1e-4);
    ASSERT_EQ(time_ns, points[i].time_ns);
    ASSERT_NEAR(x, static_cast<double>(fields[0]), 1e-6);
    ASSERT_NEAR(y, static_cast<double>(fields[1]), 1e-6);
    ASSERT_EQ(z, 0.0);
    ASSERT_NEAR(range_m, static_cast<double>(fields[3]), 1e-6);
    ASSERT_NEAR(angle_deg, static_cast<double>(fields[4]), 1e-4);
    ASSERT_EQ(text_ns, time_ns);
  }
}

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
