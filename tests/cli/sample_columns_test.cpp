// SPDX-License-Identifier: MIT
// The intensity and the flags of points as text: read, written in each format, and kept by filters.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

#include "program.hpp"
#include "support/family_reference.hpp"

namespace {

using cli::outcome;
using cli::program;
using cli::run;
using ::testing::HasSubstr;
using ::testing::Not;

/// Ranges from 1 m to 1.36 m with every intensity and all flags, one of eight without return.
const reference::family_revolutions& seen() {
  static const auto made = reference::revolutions_of(
      reference::wire_format_of("t-mini"), 4, 10, 2 * 70 + 1,
      [](unsigned turn, unsigned packet, unsigned i) {
        const unsigned range_mm = (packet + i) % 8 == 0 ? 0 : 1000 + 10 * packet + i;
        return reference::wire_sample{(turn + 7 * packet + i) % 256,
                                      4 * range_mm + (packet + i) % 4};
      });
  return made;
}

struct values {
  unsigned intensity;
  unsigned flags;
  bool operator==(const values&) const = default;
};

class SampleColumns : public cli::scratch {
 protected:
  SampleColumns() {
    cli::write_file(path("raw.bin"),
                    {reinterpret_cast<const char*>(seen().data.data()), seen().data.size()});
    convert("raw.bin", "a.csv", {"--model", "t-mini"});
    convert("raw.bin", "a.jsonl", {"--model", "t-mini"});
  }
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

/// The two last columns.
std::vector<values> columns_of(const std::string& csv) {
  std::vector<values> all;
  const auto rows = cli::lines_of(csv);
  EXPECT_EQ(rows.at(0), "scan,angle_deg,range_mm,time_ns,intensity,sample_flags");
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const std::size_t flags = rows[i].rfind(',');
    const std::size_t intensity = rows[i].rfind(',', flags - 1);
    all.push_back({static_cast<unsigned>(std::stoul(rows[i].substr(intensity + 1))),
                   static_cast<unsigned>(std::stoul(rows[i].substr(flags + 1)))});
  }
  return all;
}

template <class Taken>
std::vector<values> wanted(Taken taken) {
  std::vector<values> all;
  for (const reference::family_point& each : seen().points) {
    if (taken(each)) all.push_back({each.intensity, each.flags});
  }
  return all;
}
std::vector<values> all_wanted() {
  return wanted([](const reference::family_point&) { return true; });
}

TEST_F(SampleColumns, AreReadAndWrittenAsText) {
  EXPECT_EQ(columns_of(text("a.csv")), all_wanted());
  for (const std::vector<std::string>& model :
       {std::vector<std::string>{"--model", "t-mini"}, std::vector<std::string>{}}) {
    convert("a.csv", "b.csv", model);
    EXPECT_TRUE(text("b.csv") == text("a.csv"));
    for (const std::string from : {"a.csv", "a.jsonl"}) {
      convert(from, "b.jsonl", model);
      EXPECT_THAT(text("b.jsonl"), HasSubstr(",\"intensity\":7,\"sample_flags\":1,"));
      convert("b.jsonl", "c.csv", model);
      EXPECT_TRUE(text("c.csv") == text("a.csv")) << from;
    }
  }
}

TEST_F(SampleColumns, AreKeptByFiltersAndDeskewing) {
  convert("a.csv", "near.csv", {"--range", "1.1:1.2", "--model", "t-mini"});
  EXPECT_EQ(columns_of(text("near.csv")), wanted([](const reference::family_point& p) {
              return p.range_mm >= 1100.0 && p.range_mm <= 1200.0;
            }));
  cli::write_file(path("way.odo"), "0 0 0 0\n10000000000 5 0 0\n");
  convert("a.csv", "moved.csv",
          {"--deskew", "odometry", "--odometry", path("way.odo"), "--model", "t-mini"});
  EXPECT_EQ(columns_of(text("moved.csv")), all_wanted());
  EXPECT_FALSE(text("moved.csv") == text("a.csv"));
}

TEST_F(SampleColumns, OfALidarThatIsNotNamed_AreKeptAndReported) {
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

TEST_F(SampleColumns, WithoutAValidValue_AreReported) {
  for (const std::string wrong : {"65536,0", "-1,0", "1.5,0", "strong,0", "7,4", "7,-1", "7,0.5"}) {
    cli::write_file(path("bad.csv"),
                    "angle_deg,range_mm,intensity,sample_flags\n10,500," + wrong + "\n");
    const outcome none = run({"convert", path("bad.csv"), path("b.csv"), "--force"});
    EXPECT_EQ(none.code, 10) << wrong;
    const std::string column = wrong.starts_with("7") ? "sample_flags" : "intensity";
    EXPECT_THAT(none.err,
                HasSubstr("holds no points. Its line 2 has no valid " + column + ". Give"));
    cli::write_file(
        path("bad.csv"),
        "angle_deg,range_mm,intensity,sample_flags\n9,500,65535,3\n10,500," + wrong + "\n");
    EXPECT_THAT(convert("bad.csv", "b.csv"),
                HasSubstr("1 point, 1 line without one: line 3 has no valid " + column + "\n"));
    EXPECT_EQ(
        text("b.csv"),
        "scan,angle_deg,range_mm,time_ns,intensity,sample_flags\n0,9.000000,500.00,0,65535,3\n");
  }
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
