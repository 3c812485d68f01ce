// SPDX-License-Identifier: MIT
// --mask, --speckle and --edges of dump, scan and convert: on constructed scans.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "wanted_points.hpp"

namespace {

using namespace cli;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// 120 samples 0.28 degrees apart: at 4 m, then from the 80th on at 2 m; the 20th is at 1 m, the 79th
/// at 3 m, between both.
std::string two_walls() {
  std::vector<std::uint16_t> samples(120, 16'000);
  std::fill(samples.begin() + 80, samples.end(), std::uint16_t{8000});
  samples[20] = 4000;
  samples[79] = 12'000;
  std::string bytes = zero(99.72, 16'000);
  for (int part = 0; part < 3; ++part) {
    const double first = 100.0 + part * 40 * 0.28125;
    bytes += packet(first, first + 39 * 0.28125,
                    {samples.begin() + part * 40, samples.begin() + (part + 1) * 40});
  }
  return bytes;
}

std::vector<double> ranges_with(std::vector<std::string> options) {
  options.insert(options.begin(), {"dump", "-", "-f", "csv", "-q"});
  const outcome done = run(options, two_walls());
  EXPECT_EQ(done.code, 0) << done.err;
  std::vector<double> ranges;
  for (const row& r : rows_of(done.out)) ranges.push_back(r.range);
  return ranges;
}

std::vector<double> walls_without(const std::vector<double>& left_out) {
  std::vector<double> ranges;
  for (const double each : ranges_with({})) {
    if (std::find(left_out.begin(), left_out.end(), each) == left_out.end()) ranges.push_back(each);
  }
  return ranges;
}

class Filters : public cli::scratch_here {};

TEST_F(Filters, SpeckleAndEdges_OfPoints) {
  ASSERT_EQ(ranges_with({}).size(), 121U);
  EXPECT_EQ(ranges_with({"--edges"}), walls_without({3000}));
  EXPECT_EQ(ranges_with({"--speckle"}), walls_without({1000, 3000})) << "it is alone, too";
  EXPECT_EQ(ranges_with({"--speckle", "--edges"}), walls_without({1000, 3000}));
  EXPECT_EQ(ranges_with({"--speckle=near=1.5"}), walls_without({1000}));
  EXPECT_EQ(ranges_with({"--speckle=near=1.5,ratio=0,window=3,count=2"}), walls_without({1000}));
  EXPECT_EQ(ranges_with({"--speckle=near=4"}), walls_without({}));
  EXPECT_EQ(ranges_with({"--edges=angle=0.5"}), walls_without({})) << "the lines make 1.0 and 1.5";
  EXPECT_EQ(ranges_with({"--edges=angle=2,window=2"}), walls_without({3000}));
}

TEST_F(Filters, TheHelpShowsTheirOptionalValues) {
  const std::string help = run({"dump", "--help"}).out;
  EXPECT_THAT(help, HasSubstr("\n  --speckle[=LIMITS]                Leave out returns"));
  EXPECT_THAT(help, HasSubstr("\n  --edges[=LIMITS]                  Leave out veiling points"));
}

TEST_F(Filters, OptionsBeforeTheSource_DoNotTakeIt) {
  EXPECT_EQ(run({"dump", "--speckle", "-", "-f", "csv", "-q"}, two_walls()).out,
            run({"dump", "-", "--speckle", "-f", "csv", "-q"}, two_walls()).out);
}

// The near thing is at 105.6 degrees less a correction of 6.8 degrees: 81 degrees to the left.
TEST_F(Filters, Mask) {
  write_file("mask.txt", "# the near thing\npolygon 0 0.9  0.3 0.9  0.3 1.1  -0.3 1.1 -0.3 0.9\n");
  EXPECT_EQ(ranges_with({"--mask", "mask.txt"}), walls_without({1000}));
  EXPECT_EQ(ranges_with({"--mask", "mask.txt", "--frame", "robot"}), walls_without({1000}));
  write_file("all.txt", "polygon -5 -5 5 -5 5 5 -5 5\n");
  EXPECT_EQ(ranges_with({"--mask", "all.txt"}), std::vector<double>{});
}

TEST_F(Filters, AMaskFromStandardInput) {
  write_file("walls.bin", two_walls());
  const std::vector<std::string> arguments{"dump", "walls.bin", "-f", "csv", "-q", "--mask", "-"};
  write_file("mask.txt", "polygon 0 0.9  0.3 0.9  0.3 1.1  -0.3 1.1 -0.3 0.9\n");
  const outcome done = run(arguments, read_file("mask.txt"));
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.out, run({"dump", "walls.bin", "-f", "csv", "-q", "--mask", "mask.txt"}).out);
  const outcome wrong = run(arguments, "\npolygon 1 2 3\n");
  EXPECT_EQ(wrong.code, 10);
  EXPECT_THAT(wrong.err, HasSubstr("mask: standard input, line 2: expected 'polygon x1 y1"));
}

/// The number of ranges of the grid that are numbers, and that are "inf".
std::pair<std::size_t, std::size_t> grid_with(std::vector<std::string> options) {
  options.insert(options.begin(), {"scan", "-", "--partial", "--grid", "3600", "-f", "csv", "-q"});
  const outcome done = run(options, two_walls());
  EXPECT_EQ(done.code, 0) << done.err;
  std::istringstream cells(lines_of(done.out).at(1));
  std::size_t numbers = 0;
  std::size_t free = 0;
  for (std::string cell; std::getline(cells, cell, ',');) {
    numbers += cell.find('.') != std::string::npos ? 1U : 0U;
    free += cell == "inf" ? 1U : 0U;
  }
  return {numbers, free};
}

TEST_F(Filters, InAGrid_WhatIsLeftOutIsUnknown) {
  const auto all = grid_with({});
  EXPECT_GT(all.first, 115U);
  const std::pair<std::size_t, std::size_t> two_less{all.first - 2, 0};
  EXPECT_EQ(grid_with({"--speckle"}), two_less);
  EXPECT_EQ(grid_with({"--edges"}).first, all.first - 1);
  write_file("mask.txt", "polygon -0.3 0.9  0.3 0.9  0.3 1.1  -0.3 1.1\n");
  EXPECT_EQ(grid_with({"--mask", "mask.txt", "--range", "0:16"}).first, all.first - 1);
}

TEST_F(Filters, OfConvert) {
  write_file("walls.bin", two_walls());
  ASSERT_EQ(run({"convert", "walls.bin", "walls.csv", "-q"}).code, 0);
  ASSERT_EQ(run({"convert", "walls.csv", "clean.csv", "--speckle", "-q"}).code, 0);
  const std::string text = read_file("clean.csv");
  EXPECT_EQ(rows_of(text).size(), 119U);
  const outcome refused = run({"convert", "walls.bin", "walls.mcap", "--edges"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--edges"));
}

TEST_F(Filters, InvalidValues_AreRefused) {
  const auto refused = [](const std::vector<std::string>& options, const std::string& why,
                          int code = 2) {
    std::vector<std::string> arguments{"dump", "-"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const outcome done = run(arguments, two_walls());
    EXPECT_EQ(done.code, code) << why;
    EXPECT_EQ(done.out, "");
    EXPECT_THAT(done.err, StartsWith("g4-dump: "));
    EXPECT_THAT(done.err, HasSubstr(why));
  };
  refused({"--speckle=width=3"},
          "--speckle: 'width=3' is not one of window=N, count=N, near=N, ratio=N");
  refused({"--speckle=window"}, "'window' is not one of");
  refused({"--speckle=window=17"}, "'17' is not in the range 1 to 16");
  refused({"--speckle=window=1.5"}, "'window=1.5' is not a whole number");
  refused({"--edges=angle=46"}, "--edges: '46' is not in the range 0.1 to 45");
  refused({"--edges=angle=x"}, "'x' is not in the range");
  refused({"--mask", "no-such-file"}, "no-such-file", 10);
  write_file("wrong.txt", "\npolygon 1 2 3\n");
  refused({"--mask", "wrong.txt"}, "line 2: expected 'polygon x1 y1", 10);
}

}  // namespace
