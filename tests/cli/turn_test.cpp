// SPDX-License-Identifier: MIT
// Commands on the bytes of a model that is not turned: a T-mini looks at its 0 degrees, and its angles grow to the
// right. All values are worked out by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "program.hpp"

namespace {

using namespace cli;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A packet of one sample of 3 bytes: intensity 7, flags 2.
std::string packet(bool is_zero, unsigned angle_deg, unsigned range_mm) {
  const unsigned type = is_zero ? 1 : 0;
  const unsigned angle = angle_deg * 64 * 2 + 1;
  const unsigned range = range_mm * 4 + 2;
  const unsigned sum = 0x55AA ^ (type | 0x100) ^ angle ^ angle ^ 7 ^ range;
  std::string made = "\xAA\x55";
  made += static_cast<char>(type);
  made += '\x01';
  for (const unsigned word : {angle, angle, sum}) {
    made += static_cast<char>(word & 0xFF);
    made += static_cast<char>(word >> 8);
  }
  return made + '\x07' + static_cast<char>(range & 0xFF) + static_cast<char>(range >> 8);
}

/// One revolution, and the begin of the next: 2 m ahead, 1 m to the right, nothing behind, 3 m to the left.
std::string turn() {
  return packet(true, 0, 2000) + packet(false, 90, 1000) + packet(false, 180, 0) +
         packet(false, 270, 3000) + packet(true, 0, 2000);
}

/// The output of a command for these bytes.
std::string output_of(std::vector<std::string> words) {
  words.insert(words.begin() + 1, {"-", "--model", "t-mini-pro", "-q"});
  const outcome done = run(words, turn());
  EXPECT_EQ(done.code, 0) << done.err;
  return done.out;
}

/// Column `index` of csv, without its header.
std::vector<std::string> column(const std::string& csv, std::size_t index) {
  std::vector<std::string> found;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::string cell;
    for (std::size_t i = 0; i <= index; ++i) std::getline(cells, cell, ',');
    found.push_back(cell);
  }
  return found;
}

TEST(Turn, AnglesOfThePoints) {
  EXPECT_THAT(column(output_of({"dump", "--frame", "robot", "-f", "csv"}), 1),
              ElementsAre("0.000000", "-90.000000", "-180.000000", "90.000000", "0.000000"));
  EXPECT_THAT(output_of({"dump", "--frame", "robot", "-f", "jsonl", "-n", "2"}),
              HasSubstr("\"angle_deg\":-90.000000,\"range_mm\":1000.00"));
  EXPECT_THAT(output_of({"scan", "--frame", "robot", "-f", "jsonl"}),
              HasSubstr("\"angle_deg\":[0.000000,-90.000000,-180.000000,90.000000]"));
}

TEST(Turn, Grid) {
  EXPECT_THAT(output_of({"scan", "--grid", "4", "--frame", "robot", "-f", "csv"}),
              HasSubstr("\n0,0,false,inf,1000.00,2000.00,3000.00\n"));
  EXPECT_THAT(
      output_of({"scan", "--grid", "4", "--frame", "robot", "-f", "csv", "--no-return", "max"}),
      HasSubstr("\n0,0,false,12000.00,1000.00,2000.00,3000.00\n"));
}

TEST(Turn, FiltersAndMasks) {
  EXPECT_THAT(column(output_of({"dump", "--frame", "robot", "--fov", "-100:-80", "-f", "csv"}), 2),
              ElementsAre("1000.00"));
  const std::string path = testing::TempDir() + "turn_test_mask.txt";
  std::ofstream(path) << "polygon -0.5 2.5 0.5 2.5 0.5 3.5 -0.5 3.5\n";
  for (const char* frame : {"robot", "vendor"}) {
    EXPECT_THAT(column(output_of({"dump", "--frame", frame, "--mask", path, "-f", "csv"}), 2),
                ElementsAre("2000.00", "1000.00", "0.00", "2000.00"));
  }
}

}  // namespace
