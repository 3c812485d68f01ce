// SPDX-License-Identifier: MIT
// g4-dump scan on raw bytes: held against points that are worked out, filtered and turned here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "expected_points.hpp"
#include "program.hpp"
#include "recording.hpp"

namespace {

using namespace cli;
using nlohmann::json;
using ::testing::HasSubstr;

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
