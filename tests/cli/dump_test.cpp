// SPDX-License-Identifier: MIT
// g4-dump dump and scan on raw bytes: held against points that are worked out, filtered and turned here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "expected_points.hpp"
#include "program.hpp"
#include "recording.hpp"

namespace {

using cli::lines_of;
using cli::outcome;
using cli::row;
using cli::rows_of;
using cli::run;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double degrees_of_radian = 180.0 / std::numbers::pi;

// Going from `from` on in the direction in which angles grow, is `angle` met before or at `to`?
bool is_within(double angle, double from, double to) {
  if (to - from >= 360.0) return true;
  const double way = std::fmod(angle - from + 1080.0, 360.0);
  const double end = std::fmod(to - from + 1080.0, 360.0);
  return way <= end + 1e-9 || way >= 360.0 - 1e-9;
}

// Whether it is too near to a border for the angles of floats to decide.
bool is_doubtful(double angle, double border) {
  return std::abs(std::remainder(angle - border, 360.0)) < 1e-4;
}

double robot_deg(double angle_deg) { return std::remainder(180.0 - angle_deg, 360.0); }

const std::string& simulated() {
  static const std::string bytes = run({"sim", "--seconds", "2", "--seed", "5"}).out;
  return bytes;
}

// Around both places where angles begin anew, every 64th of a degree, far, near and without return.
const std::string& all_around() {
  static const std::string bytes = [] {
    std::string made;
    for (int angle = 0; angle < 360 * 64; angle += 7) {
      made += cli::packet(angle / 64.0, angle / 64.0, {0, 1, 400, 1120, 4000, 64000, 65535});
    }
    return made;
  }();
  return bytes;
}

struct wish {
  double fov_from = -360.0;
  double fov_to = 360.0;
  double ignore_from = 0.0;
  double ignore_to = 0.0;
  bool ignores = false;
  double range_from_mm = -1.0;
  double range_to_mm = 1e9;
};

/// A point that is to be shown, or may be.
struct wanted_point {
  std::uint64_t scan;
  double angle_deg;
  double range_mm;
  std::int64_t time_ns;
  bool is_doubtful;
};

std::vector<wanted_point> wanted_points(const std::string& bytes, bool robot, const wish& wanted) {
  std::vector<wanted_point> points;
  std::size_t index = 0;
  for (const cli::expected_point& p : cli::points_in(bytes)) {
    const std::int64_t time_ns = cli::counted_time_ns(index++);
    const double angle = robot ? robot_deg(p.angle_deg) : p.angle_deg;
    const bool is_kept =
        is_within(angle, wanted.fov_from, wanted.fov_to) &&
        !(wanted.ignores && is_within(angle, wanted.ignore_from, wanted.ignore_to));
    const bool doubtful =
        is_doubtful(angle, wanted.fov_from) || is_doubtful(angle, wanted.fov_to) ||
        is_doubtful(angle, wanted.ignore_from) || is_doubtful(angle, wanted.ignore_to);
    if (p.range_mm < wanted.range_from_mm || p.range_mm > wanted.range_to_mm) continue;
    if (is_kept || doubtful) points.push_back({p.scan, angle, p.range_mm, time_ns, doubtful});
  }
  return points;
}

/// All of them in order, where those that are doubtful may be missing; `unit_mm` is what ranges are counted in.
void expect_shown(const std::vector<row>& shown, const std::vector<wanted_point>& wanted,
                  double unit_mm = 1.0) {
  std::size_t at = 0;
  for (const wanted_point& p : wanted) {
    const bool is_here = at < shown.size() && shown[at].time_ns == p.time_ns;
    if (!is_here) {
      ASSERT_TRUE(p.is_doubtful) << p.angle_deg << " degrees at " << p.time_ns << " is missing";
      continue;
    }
    ASSERT_LT(std::abs(std::remainder(shown[at].angle_deg - p.angle_deg, 360.0)), 1e-4);
    ASSERT_NEAR(shown[at].range, p.range_mm / unit_mm, 1e-9);
    ASSERT_EQ(shown[at].scan, p.scan);
    ++at;
  }
  EXPECT_EQ(at, shown.size()) << "a point that is not wanted";
  EXPECT_GT(at, 0U);
}

void expect_filtered(const std::vector<std::string>& options, bool robot, const wish& wanted) {
  for (const std::string* const bytes : {&simulated(), &all_around()}) {
    std::vector<std::string> arguments{"dump", "-", "-f", "csv", "-q"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    if (robot) arguments.insert(arguments.end(), {"--frame", "robot"});
    const outcome done = run(arguments, *bytes);
    ASSERT_EQ(done.code, 0) << done.err;
    const std::vector<row> shown = rows_of(done.out);
    expect_shown(shown, wanted_points(*bytes, robot, wanted));
    for (const row& r : shown) {
      ASSERT_TRUE(robot ? r.angle_deg >= -180.0 && r.angle_deg < 180.0
                        : r.angle_deg >= 0.0 && r.angle_deg < 360.0);
    }
  }
}

TEST(Dump, FieldOfViewInTheVendorsFrame) {
  for (const auto& [from, to] : std::vector<std::pair<double, double>>{{-90, 90},
                                                                       {90, -90},
                                                                       {0, 360},
                                                                       {350, 10},
                                                                       {10, 350},
                                                                       {-10.5, 0},
                                                                       {0, 0.5},
                                                                       {359, 360}}) {
    wish wanted;
    wanted.fov_from = from;
    wanted.fov_to = to;
    std::ostringstream option;
    option << "--fov=" << from << ":" << to;
    SCOPED_TRACE(option.str());
    expect_filtered({option.str()}, false, wanted);
    expect_filtered({option.str()}, true, wanted);
  }
}

TEST(Dump, FieldOfViewWithASeparateWord) {
  EXPECT_EQ(run({"dump", "-", "--fov", "-90:90", "-q"}, simulated()).out,
            run({"dump", "-", "--fov=-90:90", "-q"}, simulated()).out);
}

TEST(Dump, IgnoredDirectionsAndRanges) {
  wish wanted;
  wanted.ignores = true;
  wanted.ignore_from = 170;
  wanted.ignore_to = -170;
  wanted.range_from_mm = 280;
  wanted.range_to_mm = 16000;
  for (const bool robot : {false, true}) {
    expect_filtered({"--ignore", "170:-170", "--range", "0.28:16"}, robot, wanted);
    wanted.range_from_mm = 0;
    expect_filtered({"--ignore", "170:-170", "--range", ":16"}, robot, wanted);
    wanted.range_from_mm = 280;
  }
  const std::string twice =
      run({"dump", "-", "--ignore", "0:90", "--ignore", "90:359", "-f", "csv", "-q"}, simulated())
          .out;
  for (const row& r : rows_of(twice)) ASSERT_GT(r.angle_deg, 359.0);
  EXPECT_GT(rows_of(twice).size(), 0U);
}

TEST(Dump, Metres) {
  const std::string csv = run({"dump", "-", "-f", "csv", "--unit", "m", "-q"}, all_around()).out;
  EXPECT_THAT(csv, StartsWith("scan,angle_deg,range_m,time_ns\n"));
  EXPECT_THAT(csv, HasSubstr(",16.38375,"));
  EXPECT_THAT(csv, HasSubstr(",0.00025,"));
  const std::string first =
      lines_of(run({"dump", "-", "-f", "jsonl", "--unit", "m", "-q"}, all_around()).out).at(3);
  EXPECT_EQ(json::parse(first).at("range_m"), 0.28);
  EXPECT_THAT(run({"dump", "-", "--unit", "m", "-q"}, all_around()).out, HasSubstr("  0.28000  "));
}

TEST(Dump, JsonlNamesWhatCsvNames) {
  const json first =
      json::parse(lines_of(run({"dump", "-", "-f", "jsonl", "--frame", "robot", "-q"},
                               cli::packet(90, 91, {0, 300}))
                               .out)
                      .at(1));
  EXPECT_EQ(first.size(), 6U);
  EXPECT_EQ(first.at("scan"), 0);
  EXPECT_NEAR(first.at("angle_deg").get<double>(), 180.0 - 91.0 - 8.547194, 1e-4);
  EXPECT_EQ(first.at("range_mm"), 75);
  EXPECT_EQ(first.at("time_ns"), 111111);
  EXPECT_EQ(first.at("no_return"), false);
  EXPECT_EQ(first.at("too_near"), true);
}

TEST(Dump, SoManyRecordsBehindTheFilters) {
  const std::string all = run({"dump", "-", "-f", "csv", "--fov", "10:20", "-q"}, simulated()).out;
  const std::string some =
      run({"dump", "-", "-f", "csv", "--fov", "10:20", "-n", "71", "-q"}, simulated()).out;
  EXPECT_EQ(lines_of(some).size(), 72U);
  EXPECT_THAT(all, StartsWith(some));
}

TEST(Dump, SoLongByTheTimesOfTheSamples) {
  const auto rows = rows_of(run({"dump", "-", "-f", "csv", "-d", "500ms", "-q"}, simulated()).out);
  ASSERT_EQ(rows.size(), 4500U);
  EXPECT_LT(rows.back().time_ns, 500'000'000);
}

TEST(Dump, Times) {
  const std::vector<std::string> filtered{"dump", "-", "-f", "csv", "-q", "--fov", "100:200"};
  const auto with = [&](const std::string& style) {
    std::vector<std::string> arguments = filtered;
    arguments.insert(arguments.end(), {"--time", style});
    return run(arguments, simulated()).out;
  };
  const std::vector<row> plain = rows_of(run(filtered, simulated()).out);
  EXPECT_EQ(with("zero"), run(filtered, simulated()).out);
  const std::vector<row> delta = rows_of(with("delta"));
  ASSERT_EQ(delta.size(), plain.size());
  EXPECT_EQ(delta[0].time_ns, 0);
  for (std::size_t i = 1; i < delta.size(); ++i) {
    ASSERT_EQ(delta[i].time_ns, plain[i].time_ns - plain[i - 1].time_ns);
  }
  for (const char* const style : {"abs", "mono"}) {
    const outcome refused = run({"dump", "-", "--time", style}, simulated());
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.err, StartsWith("g4-dump: --time: raw bytes carry no times"));
  }
  const auto slow =
      rows_of(run({"dump", "-", "-f", "csv", "-q", "--sample-rate", "4000"}, simulated()).out);
  EXPECT_EQ(slow.at(4).time_ns, 1'000'000);
}

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
  wish wanted;
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
  wish wanted;  // of revolution 1, the first one that is whole
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

TEST(Help, NamesEveryColumnOfDumpAndScan) {
  const auto expect_named = [](const std::string& verb, const std::vector<std::string>& options) {
    const std::string help = run({verb, "--help"}).out;
    std::vector<std::string> arguments{verb, "-", "-f", "csv", "-q"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    std::istringstream header(lines_of(run(arguments, cli::zero(0)).out).at(0));
    for (std::string column; std::getline(header, column, ',');) {
      EXPECT_THAT(help, testing::ContainsRegex("[ (]" + column + "[ ,.(;\n]"));
    }
    for (const std::string& line : lines_of(help)) EXPECT_LE(line.size(), 100U) << line;
  };
  expect_named("dump", {});
  expect_named("dump", {"--unit", "m"});
  expect_named("scan", {"--partial"});
  expect_named("scan", {"--partial", "--grid", "1"});
  expect_named("scan", {"--partial", "--grid", "1", "--unit", "m"});
}

class LongDump : public cli::scratch {
 protected:
  /// From its start to its first line.
  static std::chrono::nanoseconds time_to_first_line(const std::vector<std::string>& arguments) {
    const auto begin = std::chrono::steady_clock::now();
    cli::program started(arguments);
    started.read_until("\n");
    const auto took = std::chrono::steady_clock::now() - begin;
    started.close_output();
    EXPECT_EQ(started.wait().code, 0);
    return took;
  }
  static outcome dump(const std::string& name, const std::vector<std::string>& options) {
    std::vector<std::string> arguments{"dump", name, "-q"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    cli::program started(arguments, {{}, cli::stream::of_file("/dev/null"), {}});
    return started.wait();
  }
};

TEST_F(LongDump, TakesNoMoreMemoryThanAShortOne) {
  cli::write_repeated(path("short.bin"), cli::zero(0) + cli::turn(), 500'000);
  cli::write_repeated(path("long.bin"), cli::zero(0) + cli::turn(), 10'000'000);
  const std::vector<std::string> options{"-f",     "csv",     "--frame", "robot",  "--fov",
                                         "-90:90", "--range", "0.1:16",  "--time", "delta"};
  const outcome few = dump(path("short.bin"), options);
  const outcome many = dump(path("long.bin"), options);
  EXPECT_EQ(many.code, 0);
  EXPECT_LT(many.max_rss_kib, few.max_rss_kib + 2048);
}

// At one sample a second a file of some megabytes is a year long: no time overflows on the way, the
// last one is exact, and the memory is that of a minute.
TEST_F(LongDump, IsAYearLong) {
  constexpr std::int64_t samples_of_block = 1 + 9 * 40;
  const std::string block = cli::zero(0, 0) + cli::turn();
  const std::int64_t blocks = 31'536'000 / samples_of_block + 1;
  cli::write_repeated(path("minute.bin"), block, block.size());
  cli::write_repeated(path("year.bin"), block, block.size() * static_cast<std::uint64_t>(blocks));
  const auto thinned = [&](const std::string& name) {  // to the zero packets: nothing came back
    return run({"dump", path(name), "-q", "-f", "csv", "--sample-rate", "1", "--range", "0:0.1",
                "-o", path(name + ".csv")});
  };
  const outcome minute = thinned("minute.bin");
  const outcome year = thinned("year.bin");
  ASSERT_EQ(year.code, 0) << year.err;
  EXPECT_LT(year.max_rss_kib, minute.max_rss_kib + 2048);
  const std::vector<std::string> lines = lines_of(cli::read_file(path("year.bin.csv")));
  EXPECT_EQ(lines.back().substr(lines.back().rfind(',') + 1),
            std::to_string((blocks - 1) * samples_of_block * 1'000'000'000));
}

// The first line of a long file comes before a fortieth of the time that all of it takes: the median of 21 runs,
// each less the time that the program takes to start.
TEST_F(LongDump, BeginsAtOnce) {
  cli::write_repeated(path("long.bin"), cli::zero(0) + cli::turn(), 20'000'000);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(dump(path("long.bin"), {"-f", "csv"}).code, 0);
  const std::chrono::nanoseconds whole = std::chrono::steady_clock::now() - begin;
  std::vector<std::chrono::nanoseconds> later;
  for (int i = 0; i < 21; ++i) {
    const auto start = time_to_first_line({"--version"});
    later.push_back(time_to_first_line({"dump", path("long.bin"), "-f", "csv", "-q"}) - start);
  }
  std::sort(later.begin(), later.end());
  EXPECT_LE(later[later.size() / 2], whole / 40);
}

TEST(Dump, WhatMakesNoSenseIsRefused) {
  const auto refused = [](const std::vector<std::string>& options, const std::string& why) {
    std::vector<std::string> arguments{"dump", "-"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const outcome done = run(arguments, simulated());
    EXPECT_EQ(done.code, 2) << why;
    EXPECT_EQ(done.out, "");
    EXPECT_THAT(done.err, StartsWith("g4-dump: "));
    EXPECT_THAT(done.err, HasSubstr(why));
    EXPECT_EQ(lines_of(done.err).size(), 1U);
  };
  refused({"--range", "16:0.28"}, "ends before it begins");
  refused({"--range", "5"}, "'5' is not a range");
  refused({"--fov", "-400:0"}, "--fov");
  refused({"--frame", "map"}, "not one of vendor, robot");
  refused({"--unit", "ft"}, "not one of mm, m");
  refused({"--time", "utc"}, "--time");
  refused({"-n", "0"}, "--count");
  refused({"-d", "0"}, "--duration");
  refused({"--grid", "3"}, "unknown option");
}

}  // namespace
