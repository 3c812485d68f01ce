// SPDX-License-Identifier: MIT
// g4-dump convert --deskew: a robot drives towards a wall and turns in front of it.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
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
  /// How far from the walls the points are, in metres: the 90th percentile. The pose of each revolution is that in
  /// the TUM file; the points are those of the csv file.
  double off_the_walls(const std::vector<std::string>& options) {
    std::vector<std::string> words{"convert", path("way.bin"), path("way.csv"), "--force",
                                   "--frame", "robot",         "--unit",        "m",
                                   "--range", "0.1:",          "--odometry",    path("way.odo")};
    words.insert(words.end(), options.begin(), options.end());
    const outcome done = run(words);
    EXPECT_EQ(done.code, 0) << done.err;
    struct pose {
      double x, y, yaw;
    };
    std::map<long long, pose> poses;  // by the time of the first point, in microseconds
    for (const std::string& line : cli::lines_of(cli::read_file(path("way.tum")))) {
      const auto word = numbers(line, ' ');
      poses[std::llround(word.at(0) * 1e6)] = {word.at(1), word.at(2),
                                               2.0 * std::atan2(word.at(6), word.at(7))};
    }
    std::vector<double> off;
    long long scan = -1;
    const pose* from = nullptr;
    const auto rows = cli::lines_of(cli::read_file(path("way.csv")));
    for (std::size_t i = 1; i < rows.size(); ++i) {
      const auto word = numbers(rows[i], ',');
      if (std::llround(word.at(0)) != scan) {
        scan = std::llround(word.at(0));
        const auto found = poses.find(std::llround(std::floor(word.at(3) / 1e3)));
        from = found == poses.end() ? nullptr : &found->second;
      }
      if (from == nullptr) continue;  // not a whole revolution
      const double direction = from->yaw + word.at(1) * std::numbers::pi / 180.0;
      const double x = from->x + word.at(2) * std::cos(direction);
      const double y = from->y + word.at(2) * std::sin(direction);
      off.push_back(std::min(std::fabs(std::fabs(x) - 4.0), std::fabs(std::fabs(y) - 3.0)));
    }
    EXPECT_GT(off.size(), 30'000U);
    std::sort(off.begin(), off.end());
    return off.empty() ? 99.0 : off[off.size() * 9 / 10];
  }
  static std::vector<double> numbers(const std::string& line, char between) {
    std::vector<double> all;
    for (std::size_t at = 0; at < line.size(); at = line.find(between, at) + 1) {
      all.push_back(std::strtod(line.c_str() + at, nullptr));
      if (line.find(between, at) == std::string::npos) break;
    }
    return all;
  }
};

TEST_F(Deskew, EachRevolutionIsSeenFromThePlaceOfItsFirstPoint) {
  ASSERT_EQ(run({"convert", path("way.bin"), path("way.tum"), "--odometry", path("way.odo")}).code,
            0);
  EXPECT_GT(off_the_walls({}), 0.1);
  EXPECT_LT(off_the_walls({"--deskew", "odometry"}), 0.003);
  EXPECT_LT(off_the_walls({"--deskew", "scans"}), 0.03);
}

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
    EXPECT_EQ(cli::lines_of(cli::read_file(path(name))).size(), 7U) << "a second at 7 Hz";
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

TEST_F(Deskew, InvalidMount_IsRefused) {
  for (const std::string word : {"1,2", "1,2,x", "1,2,3,up", "1e9,0,0", "", ",,"}) {
    const outcome done =
        run({"convert", path("way.bin"), path("no.csv"), "--mount", word, "--deskew", "scans"});
    EXPECT_EQ(done.code, 2) << word;
    EXPECT_THAT(done.err, HasSubstr("--mount")) << word;
  }
}

}  // namespace
