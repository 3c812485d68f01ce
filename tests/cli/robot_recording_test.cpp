// SPDX-License-Identifier: MIT
// Recordings of a robot that drives: odometry, the place of the lidar, points and the order of scans.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "g4lidar/recording/reader.hpp"
#include "program.hpp"
#include "support/cdr_reader.hpp"
#include "support/mcap_messages.hpp"

namespace {

using cli::outcome;
using cli::read_file;
using cli::run;
using cli::write_file;
using g4lidar::recorded_item;
using g4lidar::stamped_odometry;
using g4lidar::test::cdr_reader;
using g4lidar::test::mcap_messages;
using ::testing::HasSubstr;

/// Raw bytes in a file begin at this time.
constexpr std::int64_t begin_ns = 1'000'000'000;

struct pose_line {
  std::int64_t time_ns;
  double x_m, y_m, yaw_rad;
};

class RobotRecording : public cli::scratch {
 protected:
  void SetUp() override {
    write_file(path("way.txt"), "drive forward 0.4 0.5\ndrive turn 120 90\n");
    const outcome made = run({"sim", "--seconds", "3", "--path", path("way.txt"), "--odometry",
                              path("way.odo"), "--truth", path("way.csv"), "-o", path("way.bin")});
    ASSERT_EQ(made.code, 0) << made.err;
  }
  void expect_good(const std::vector<std::string>& words) {
    const outcome done = run(words);
    ASSERT_EQ(done.code, 0) << done.err;
  }
  void expect_refused(const std::vector<std::string>& words, int code, const std::string& why) {
    const outcome done = run(words);
    EXPECT_EQ(done.code, code) << done.err;
    EXPECT_THAT(done.err, HasSubstr(why));
    EXPECT_FALSE(std::filesystem::exists(path("no.mcap")));
  }
  [[nodiscard]] std::vector<pose_line> lines(const std::string& name) const {
    std::vector<pose_line> all;
    std::istringstream text(read_file(path(name)));
    for (pose_line each{}; text >> each.time_ns >> each.x_m >> each.y_m >> each.yaw_rad;) {
      all.push_back(each);
    }
    return all;
  }
  [[nodiscard]] std::vector<stamped_odometry> odometry_of(const std::string& name) const {
    std::vector<stamped_odometry> all;
    auto reader = g4lidar::recording_reader::open(path(name));
    EXPECT_TRUE(reader);
    EXPECT_TRUE(!reader || reader->for_each([&](const recorded_item& item) {
      if (item.what == recorded_item::kind::odometry) all.push_back(item.odometry);
      return true;
    }));
    return all;
  }
};

TEST_F(RobotRecording, Convert_HasTheOdometryOfTheFile) {
  expect_good({"convert", path("way.bin"), path("way.mcap"), "--odometry", path("way.odo")});
  const auto wanted = lines("way.odo");
  const auto got = odometry_of("way.mcap");
  ASSERT_GT(wanted.size(), 100U);
  ASSERT_GE(got.size() + 1, wanted.size());  // the last one may not be needed
  for (std::size_t i = 0; i < got.size(); ++i) {
    EXPECT_EQ(got[i].time_ns, wanted[i].time_ns + begin_ns);
    EXPECT_EQ(got[i].pose.x_m, wanted[i].x_m);
    EXPECT_EQ(got[i].pose.y_m, wanted[i].y_m);
    EXPECT_NEAR(got[i].pose.yaw_rad, wanted[i].yaw_rad, 1e-12);
    if (i == 0) continue;
    const double seconds = static_cast<double>(wanted[i].time_ns - wanted[i - 1].time_ns) / 1e9;
    EXPECT_NEAR(got[i].twist.yaw_rad_per_s * seconds, wanted[i].yaw_rad - wanted[i - 1].yaw_rad,
                1e-9);
    EXPECT_NEAR(std::hypot(got[i].twist.x_m_per_s, got[i].twist.y_m_per_s) * seconds,
                std::hypot(wanted[i].x_m - wanted[i - 1].x_m, wanted[i].y_m - wanted[i - 1].y_m),
                1e-6);
  }
  EXPECT_EQ(run({"replay", "--verify", path("way.mcap")}).code, 0);
}

TEST_F(RobotRecording, RecordedAgain_KeepsTheOdometry) {
  expect_good({"convert", path("way.bin"), path("way.mcap"), "--odometry", path("way.odo")});
  expect_good({"convert", path("way.mcap"), path("again.mcap"), "--compress"});
  expect_good({"record", path("way.mcap"), path("more.mcap"), "--points", "--no-scans"});
  const auto wanted = odometry_of("way.mcap");
  ASSERT_GT(wanted.size(), 100U);
  for (const std::string name : {"again.mcap", "more.mcap"}) {
    const auto got = odometry_of(name);
    ASSERT_EQ(got.size(), wanted.size()) << name;
    for (std::size_t i = 0; i < got.size(); ++i) {
      EXPECT_EQ(got[i].time_ns, wanted[i].time_ns);
      EXPECT_EQ(got[i].pose.x_m, wanted[i].pose.x_m);
      EXPECT_NEAR(got[i].pose.yaw_rad, wanted[i].pose.yaw_rad, 1e-12);
    }
    EXPECT_EQ(run({"replay", "--verify", path(name)}).code, 0);
  }
  EXPECT_TRUE(mcap_messages(read_file(path("more.mcap")), "/scan").empty());
  EXPECT_GT(mcap_messages(read_file(path("more.mcap")), "/points").size(), 15U);
  // A file replaces the odometry; its times are those of the recording.
  write_file(path("other.odo"), "1500000000 1 2 0\n1600000000 1 2 0.5 # later\n");
  expect_good({"convert", path("way.mcap"), path("other.mcap"), "--odometry", path("other.odo")});
  const auto other = odometry_of("other.mcap");
  ASSERT_EQ(other.size(), 2U);
  EXPECT_EQ(other[1].time_ns, 1'600'000'000);
}

/// Of a device in real time, whose path began when it was opened.
TEST_F(RobotRecording, SimulatedRobot_HasItsOwnOdometry) {
  write_file(path("long.txt"), "drive forward 3 0.5\n");
  expect_good({"record", "sim:?path=" + path("long.txt"), path("own.mcap"), "-n", "8"});
  const auto got = odometry_of("own.mcap");
  ASSERT_GT(got.size(), 40U);
  EXPECT_GT(got.back().pose.x_m, got.front().pose.x_m + 0.1) << "it has moved";
  for (std::size_t i = 1; i < got.size(); ++i) {
    EXPECT_EQ(got[i].time_ns - got[i - 1].time_ns, 20'000'000);
    EXPECT_NEAR(got[i].pose.x_m - got[i - 1].pose.x_m, got[i].twist.x_m_per_s * 0.02, 1e-9);
  }
  expect_good({"convert", path("own.mcap"), path("own.csv"), "--time", "mono"});
  const auto rows = cli::lines_of(read_file(path("own.csv")));
  const auto time_in = [](const std::string& row) {
    return std::stoll(row.substr(row.rfind(',') + 1));
  };
  EXPECT_LE(got.front().time_ns, time_in(rows[1]));
  EXPECT_GE(got.back().time_ns, time_in(rows.back()));
}

TEST_F(RobotRecording, MountAndOrder) {
  const outcome made = run({"convert", path("way.bin"), path("way.mcap"), "--mount",
                            "0.5,-0.25,90,down", "--order", "time", "--points"});
  EXPECT_EQ(made.code, 0);
  EXPECT_NE(made.err.find("--order time is not for slam_toolbox"), std::string::npos) << made.err;
  const std::string file = read_file(path("way.mcap"));
  const auto transforms = mcap_messages(file, "/tf_static");
  ASSERT_EQ(transforms.size(), 1U);
  cdr_reader read(transforms[0]);
  for (int i = 0; i < 3; ++i) static_cast<void>(read.number<std::uint32_t>());
  EXPECT_EQ(read.text(), "base_link");
  EXPECT_EQ(read.text(), "laser");
  // Top down and z down: only the quarter turn is left.
  const double half = 0.70710678118654752;
  for (const double value : {0.5, -0.25, 0.0, 0.0, 0.0, half, half}) {
    EXPECT_NEAR(read.number<double>(), value, 1e-9);
  }
  const auto scans = mcap_messages(file, "/scan");
  ASSERT_GT(scans.size(), 15U);
  cdr_reader scan(scans[5]);
  for (int i = 0; i < 2; ++i) static_cast<void>(scan.number<std::uint32_t>());
  EXPECT_EQ(scan.text(), "laser");
  for (int i = 0; i < 3; ++i) static_cast<void>(scan.number<float>());
  EXPECT_NEAR(scan.number<float>(), 1.0 / 7.0 / 720.0, 1e-5);
}

TEST_F(RobotRecording, Mistakes_AreRefused) {
  write_file(path("bad.odo"), "0 0 0 0\n5 0 zero 0\n");
  const std::string in = path("way.bin");
  const std::string out = path("no.mcap");
  expect_refused({"convert", in, out, "--odometry", path("bad.odo")}, 10,
                 "line 2: 'zero' is not a number");
  expect_refused({"record", in, out, "--odometry", path("bad.odo")}, 10, "line 2");
  expect_refused({"convert", in, out, "--odometry", path("missing.odo")}, 10, "missing.odo");
  for (const std::string mount :
       {"1,2", "1,2,3,4", "1,2,3,up", "a,2,3", "1,2,2000", "1e9,0,0", "", ",,"}) {
    expect_refused({"record", in, out, "--mount", mount}, 2, "--mount");
  }
  expect_refused({"record", in, out, "--order", "space"}, 2, "space");
  expect_refused({"convert", in, path("no.csv"), "--points"}, 2, "--points");
  EXPECT_FALSE(std::filesystem::exists(path("no.csv")));
}

}  // namespace
