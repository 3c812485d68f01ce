// SPDX-License-Identifier: MIT
// The intensity and the flags of points as text: of which lidar they are, and what is reported.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "program.hpp"

namespace {

using cli::outcome;
using cli::run;
using ::testing::HasSubstr;
using ::testing::Not;

class SampleColumns : public cli::scratch {
 protected:
  std::string convert(const std::string& from, const std::string& to,
                      const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"convert", path(from), path(to), "--force"};
    words.insert(words.end(), more.begin(), more.end());
    const outcome done = run(words);
    EXPECT_EQ(done.code, 0) << from << " to " << to << ": " << done.err;
    return done.err;
  }
  [[nodiscard]] std::string text(const std::string& name) const {
    return cli::read_file(path(name));
  }
};

TEST_F(SampleColumns, OfALidarThatIsNotNamed_AreKeptAndReported) {
  cli::write_file(path("a.csv"),
                  "scan,angle_deg,range_mm,time_ns,intensity,sample_flags\n"
                  "0,10.000000,1000.00,0,255,3\n0,10.500000,0.00,250000,7,1\n");
  const std::string how = convert("a.csv", "b.csv");
  EXPECT_THAT(
      how,
      HasSubstr(
          "a.csv' has intensity, which a G4 does not measure; its directions are read as those "
          "of a G4; --model names another\n"));
  EXPECT_THAT(convert("a.csv", "b.csv", {"--model", "t-mini"}), Not(HasSubstr("measure")));
  // An X4 has flags and no intensity; what is named is not reported again.
  EXPECT_THAT(convert("a.csv", "b.csv", {"--model", "x4"}), Not(HasSubstr("measure")));
  EXPECT_EQ(text("b.csv"), text("a.csv"));
  cli::write_file(path("g4.csv"), "scan,angle_deg,range_mm,time_ns\n0,1,500,0\n");
  EXPECT_THAT(convert("g4.csv", "b.csv"), Not(HasSubstr("measure")));
  EXPECT_EQ(text("b.csv"), "scan,angle_deg,range_mm,time_ns\n0,1.000000,500.00,0\n");
}

TEST_F(SampleColumns, OfLaterLinesOnly_AreRefused) {
  cli::write_file(
      path("late.jsonl"),
      "{\"angle_deg\":1,\"range_mm\":500}\n{\"angle_deg\":2,\"range_mm\":500,\"intensity\":7}\n");
  const outcome done = run({"convert", path("late.jsonl"), path("b.csv")});
  EXPECT_EQ(done.code, 10);
  EXPECT_THAT(done.err,
              HasSubstr("has intensity only in later lines, and a G4 does not measure it. Name the "
                        "lidar that measured these points with --model."));
  EXPECT_EQ(listing().find("b.csv"), std::string::npos);
  EXPECT_EQ(run({"convert", path("late.jsonl"), path("b.csv"), "--model", "g2"}).code, 0);
  EXPECT_THAT(text("b.csv"), HasSubstr("\n0,1.000000,500.00,0,0\n0,2.000000,500.00,0,7\n"));
}

TEST_F(SampleColumns, PointsThatNameNoLidar_AreTurnedWithAWord) {
  cli::write_file(path("g4.csv"), "angle_deg,range_mm,time_ns\n10.0,1000.0,1\n20.0,1000.0,2\n");
  const std::string words = "its points are turned as those of a G4; --model names another";
  const outcome turned = run({"convert", path("g4.csv"), path("robot.csv"), "--frame", "robot"});
  ASSERT_EQ(turned.code, 0) << turned.err;
  EXPECT_THAT(turned.err, HasSubstr(words));
  const outcome native = run({"convert", path("g4.csv"), path("native.csv")});
  EXPECT_THAT(native.err, Not(HasSubstr(words)));
  const outcome named =
      run({"convert", path("g4.csv"), path("x4.csv"), "--frame", "robot", "--model", "x4"});
  EXPECT_THAT(named.err, Not(HasSubstr(words)));
}

}  // namespace
