// SPDX-License-Identifier: MIT
// g4-dump convert --deskew: what it counts and refuses. Its points are those of the library (equal_shapes_test.cpp).
#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <vector>

#include "program.hpp"

namespace {

using cli::outcome;
using cli::run;
using ::testing::HasSubstr;

class Deskew : public cli::scratch {
 protected:
  void SetUp() override {
    // A room of 8 by 6 m, and a lidar that looks ahead.
    cli::write_file(path("room.txt"),
                    "wall -4 -3 4 -3\nwall 4 -3 4 3\nwall 4 3 -4 3\nwall -4 3 -4 -3\n"
                    "mount 0,0,0\nlidar 0 0 0\ndrive forward 2 1\ndrive turn 180 90\n");
    const outcome made = run({"sim", "--seconds", "6", "--world", path("room.txt"), "--odometry",
                              path("way.odo"), "-o", path("way.bin")});
    ASSERT_EQ(made.code, 0) << made.err;
  }
};

/// The estimator sees the whole revolution, whatever is written of it.
TEST_F(Deskew, ByScans_OfAFieldOfView) {
  const outcome done = run({"convert", path("way.bin"), path("way.xyz"), "--deskew", "scans",
                            "--frame", "robot", "--fov", "-45:45"});
  EXPECT_EQ(done.code, 0);
  const auto at = done.err.find(" points not deskewed");
  const auto from = done.err.rfind('\n', at) + 1;
  ASSERT_NE(at, std::string::npos) << done.err << " (at least the first revolution)";
  EXPECT_LT(std::stod(done.err.substr(from, at - from)), 3000.0) << "of 13,000";
}

TEST_F(Deskew, OdometryOfAPart_GivesPosesForThatPartOnly) {
  std::string part;
  for (const std::string& line : cli::lines_of(cli::read_file(path("way.odo")))) {
    const double seconds = std::strtod(line.c_str(), nullptr) / 1e9;
    if (seconds >= 2.0 && seconds <= 3.0) part += line + "\n";
  }
  cli::write_file(path("part.odo"), part);
  for (const std::string name : {"part.tum", "part.carmen"}) {
    const outcome done =
        run({"convert", path("way.bin"), path(name), "--odometry", path("part.odo")});
    EXPECT_EQ(done.code, 0);
    EXPECT_THAT(done.err, HasSubstr("left out: the odometry has no pose at their time"));
    const auto lines = cli::lines_of(cli::read_file(path(name)));
    EXPECT_EQ(lines.size(), 7U) << "a second at 7 Hz";
    const int blanks = name == "part.tum" ? 7 : 8 + 1440 + 1 + 6 + 5 + 3;
    for (const std::string& each : lines) EXPECT_EQ(std::ranges::count(each, ' '), blanks);
  }
}

TEST_F(Deskew, TimesThatGoBack_AreRefused) {
  const outcome done = run({"convert", path("way.bin"), path("no.tum"), "--odometry",
                            path("way.odo"), "--time", "delta"});
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, HasSubstr("times that do not go back"));
}

TEST_F(Deskew, WhatHasNoPoses_IsRefused) {
  for (const auto& words : {std::vector<std::string>{path("no.csv"), "--deskew", "odometry"},
                            std::vector<std::string>{path("no.tum")}}) {
    std::vector<std::string> all{"convert", path("way.bin")};
    all.insert(all.end(), words.begin(), words.end());
    const outcome done = run(all);
    EXPECT_EQ(done.code, 2);
    EXPECT_THAT(done.err, HasSubstr("has no poses of the robot: give --odometry FILE"));
  }
}

TEST_F(Deskew, OdometryThatEndsEarly_IsReported) {
  cli::write_file(path("short.odo"), "0 0 0 0\n1000000000 0 0 0\n");
  const outcome done = run({"convert", path("way.bin"), path("way.xyz"), "--deskew", "odometry",
                            "--odometry", path("short.odo")});
  EXPECT_EQ(done.code, 0);
  EXPECT_THAT(done.err, HasSubstr("not deskewed: the odometry has no pose at their time"));
}

}  // namespace
