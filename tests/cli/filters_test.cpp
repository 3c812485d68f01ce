// SPDX-License-Identifier: MIT
// --mask, --speckle and --edges of dump, scan and convert: on constructed scans.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "expected_points.hpp"
#include "program.hpp"
#include "recording.hpp"

namespace {

using namespace cli;
using ::testing::HasSubstr;

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

class Filters : public cli::scratch_here {};

TEST_F(Filters, TheHelpShowsTheirOptionalValues) {
  const std::string help = run({"dump", "--help"}).out;
  EXPECT_THAT(help, HasSubstr("\n  --speckle[=LIMITS]                Leave out returns"));
  EXPECT_THAT(help, HasSubstr("\n  --edges[=LIMITS]                  Leave out veiling points"));
}

TEST_F(Filters, OptionsBeforeTheSource_DoNotTakeIt) {
  EXPECT_EQ(run({"dump", "--speckle", "-", "-f", "csv", "-q"}, two_walls()).out,
            run({"dump", "-", "--speckle", "-f", "csv", "-q"}, two_walls()).out);
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

}  // namespace
