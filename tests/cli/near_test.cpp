// SPDX-License-Identifier: MIT
// --near, --near-as and --no-return of dump, scan, convert and record: on two constructed revolutions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "program.hpp"
#include "recording.hpp"

namespace {

using namespace cli;
using ::testing::HasSubstr;
using ::testing::Not;

/// 40 beams with returns from 0.4 m, in the next revolution without; 40 others without in both.
std::string something_came_nearer() {
  const auto beams = [](double first, std::uint16_t raw) {
    return packet(first, first + 39 * 0.28125, std::vector<std::uint16_t>(40, raw));
  };
  return zero(99.72, 1600) + beams(100, 1600) + beams(200, 0) + zero(99.72, 0) + beams(100, 0) +
         beams(200, 0) + zero(99.72, 0);
}

/// The second revolution as 120 ranges, or why not.
std::string grid_with(std::vector<std::string> options) {
  options.insert(options.begin(), {"scan", "-", "--partial", "--grid", "120", "-f", "csv", "-q"});
  const outcome done = run(options, something_came_nearer());
  if (done.code != 0) return done.err;
  const auto lines = lines_of(done.out);
  EXPECT_GE(lines.size(), 3U);
  return lines.size() < 3 ? "" : lines[2];
}

class Near : public cli::scratch_here {};

TEST_F(Near, InAGrid_ADirectionThatMayBeTooNearIsNotFree) {
  const std::string all_free = grid_with({});
  EXPECT_THAT(all_free, HasSubstr(",inf,"));
  EXPECT_THAT(all_free, Not(HasSubstr("-inf")));
  const auto count = [](const std::string& text, const std::string& word) {
    std::size_t found = 0;
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; ++at) ++found;
    return found;
  };
  const std::string unknown = grid_with({"--near"});
  // 40 beams are 11 degrees, 3 or 4 ranges.
  EXPECT_GE(count(unknown, ",nan"), count(all_free, ",nan") + 3);
  EXPECT_THAT(unknown, HasSubstr(",inf,")) << "of the other beams";
  const std::string near = grid_with({"--near", "--near-as", "minus-inf"});
  EXPECT_GE(count(near, ",-inf"), 3U);
  EXPECT_EQ(count(near, ",nan"), count(all_free, ",nan"));
  EXPECT_EQ(grid_with({"--near=shortest=0.1"}), all_free) << "0.4 m is not near then";
  EXPECT_THAT(grid_with({"--near=far=1"}), HasSubstr("shortest=N, revolutions=N"));
}

TEST_F(Near, NoReturn_IsWhatTheOptionSets) {
  const std::string max = grid_with({"--no-return", "max"});
  EXPECT_THAT(max, HasSubstr(",16000.00,"));
  EXPECT_THAT(max, Not(HasSubstr("inf")));
  EXPECT_THAT(grid_with({"--no-return", "nan"}), Not(HasSubstr("inf")));
  EXPECT_EQ(grid_with({"--no-return", "inf"}), grid_with({}));
  EXPECT_THAT(grid_with({"--no-return", "far"}), HasSubstr("far"));
}

TEST_F(Near, IsForTheMessagesOfARecordingToo) {
  write_file("near.bin", something_came_nearer());
  const outcome good = run({"convert", "near.bin", "near.mcap", "--near", "--near-as", "minus-inf",
                            "--no-return", "max"});
  EXPECT_EQ(good.code, 0) << good.err;
  const outcome bad = run({"convert", "near.bin", "near.csv", "--no-return", "max"});
  EXPECT_EQ(bad.code, 2);
  EXPECT_THAT(bad.err, HasSubstr("--no-return and --near-as are for recordings"));
}

}  // namespace
