// SPDX-License-Identifier: MIT
// g4-dump dump on raw bytes: held against points that are worked out, filtered and turned here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "expected_points.hpp"
#include "program.hpp"
#include "recording.hpp"

namespace {

using namespace cli;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Dump, Count_IsAppliedAfterTheFilters) {
  const std::string all = run({"dump", "-", "-f", "csv", "--fov", "10:20", "-q"}, simulated()).out;
  const std::string some =
      run({"dump", "-", "-f", "csv", "--fov", "10:20", "-n", "71", "-q"}, simulated()).out;
  EXPECT_EQ(lines_of(some).size(), 72U);
  EXPECT_THAT(all, StartsWith(some));
}

TEST(Dump, Duration_IsCountedByTheTimesOfTheSamples) {
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

TEST(Dump, InvalidOptions_AreRefused) {
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
  refused({"--ignore", ""}, "the value is empty; give directions: 30:40");
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
