// SPDX-License-Identifier: MIT
// g4-dump convert: round trips, parts, what is damaged, what makes no sense, and its memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "program.hpp"
#include "recorded.hpp"
#include "recording.hpp"

namespace {

using cli::outcome;
using cli::program;
using cli::run;
using cli::stream;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

class Convert : public cli::scratch {
 protected:
  // Raw bytes of so many seconds of a simulated lidar.
  std::string raw(const std::string& seconds) {
    const std::string name = path("raw.bin");
    EXPECT_EQ(run({"sim", "--seconds", seconds, "-o", name}).code, 0);
    return name;
  }
  void convert(const std::string& from, const std::string& to,
               const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"convert", path(from), path(to)};
    words.insert(words.end(), more.begin(), more.end());
    const outcome done = run(words);
    EXPECT_EQ(done.code, 0) << from << " to " << to << ": " << done.err;
    EXPECT_EQ(done.out, "");
  }
  void expect_refused(std::vector<std::string> words, int code, const std::string& why) {
    words.insert(words.begin(), "convert");
    const std::string before = listing();
    const outcome done = run(words);
    EXPECT_EQ(done.code, code) << done.err;
    EXPECT_THAT(done.err, HasSubstr(why));
    EXPECT_EQ(listing(), before) << "something was left";
  }
  [[nodiscard]] std::string text(const std::string& name) const {
    return cli::read_file(path(name));
  }
  [[nodiscard]] std::vector<std::string> rows(const std::string& name) const {
    return cli::lines_of(text(name));
  }
};

TEST_F(Convert, RawBytes_AreTheSameThroughARecording) {
  const std::string bytes = cli::read_file(raw("3"));
  convert("raw.bin", "walk.mcap");
  convert("walk.mcap", "again.bin");
  EXPECT_EQ(text("again.bin"), bytes);
  convert("walk.mcap", "second.mcap", {"--compress"});
  EXPECT_LT(fs::file_size(path("second.mcap")), fs::file_size(path("walk.mcap")));
  convert("second.mcap", "again.bin", {"--force"});
  EXPECT_EQ(text("again.bin"), bytes);
  EXPECT_EQ(run({"replay", "--verify", path("second.mcap")}).code, 0);
}

/// The number of points in the header of a npy file.
long points_in(const std::string& npy) {
  const std::size_t at = npy.find("'shape': (");
  return at == std::string::npos ? -1 : std::stol(npy.substr(at + 10));
}

TEST_F(Convert, FilesOfAllPoints_HaveAsManyPointsAsTheCsv) {
  raw("2");
  convert("raw.bin", "walk.mcap");
  for (const std::string form : {"csv", "npy", "npz", "ply", "xyz"})
    convert("walk.mcap", "a." + form);
  const long points = static_cast<long>(cli::lines_of(text("a.csv")).size()) - 1;
  EXPECT_GT(points, 10'000);
  EXPECT_EQ(points_in(text("a.npy")), points);
  EXPECT_EQ(text("a.npy").size(), 256U + static_cast<std::size_t>(points) * 24);
  EXPECT_THAT(text("a.npz"), HasSubstr(text("a.npy")));
  const auto returns = cli::lines_of(text("a.xyz")).size();
  EXPECT_THAT(text("a.ply"), HasSubstr("\nelement vertex " + std::to_string(returns) + " "));
  convert("a.csv", "b.npy");
  EXPECT_EQ(points_in(text("b.npy")), points);
  convert("walk.mcap", "near.npy", {"--range", "0.5:1"});
  EXPECT_LT(points_in(text("near.npy")), points);
  convert("walk.mcap", "none.npy", {"--range", "0.001:0.002"});
  EXPECT_EQ(points_in(text("none.npy")), 0);
  const outcome piped = run({"convert", path("walk.mcap"), "-", "--to-format", "npy"});
  EXPECT_EQ(piped.code, 2);
  EXPECT_THAT(piped.err, HasSubstr("this format is written to a file, not to standard output"));
  EXPECT_THAT(run({"convert", path("a.npy"), path("c.csv")}).err,
              HasSubstr("written, but not read"));
}

TEST_F(Convert, OutputThroughALink_ReplacesTheTargetAndKeepsItsPermissions) {
  raw("1");
  cli::write_file(path("real.mcap"), "older");
  fs::permissions(path("real.mcap"), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("real.mcap", path("link.mcap"));
  convert("raw.bin", "link.mcap", {"--force"});
  EXPECT_TRUE(fs::is_symlink(path("link.mcap"))) << listing();
  EXPECT_EQ(fs::status(path("real.mcap")).permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(run({"replay", "--verify", path("real.mcap")}).code, 0);
}

TEST_F(Convert, Text_IsWrittenAsItWasRead) {
  raw("2");
  convert("raw.bin", "a.csv");
  convert("a.csv", "b.csv");
  EXPECT_EQ(text("b.csv"), text("a.csv"));
  convert("raw.bin", "a.jsonl");
  convert("a.jsonl", "b.jsonl");
  EXPECT_EQ(text("b.jsonl"), text("a.jsonl"));
  convert("a.jsonl", "c.csv");
  EXPECT_EQ(text("c.csv"), text("a.csv"));
  // The robot looks at 180 degrees of a G4, and turns to the other side.
  cli::write_file(path("g4.csv"),
                  "scan,angle_deg,range_mm,time_ns\n0,10.000000,1500.25,0\n1,190.500000,0.00,7\n");
  convert("g4.csv", "m.csv", {"--unit", "m", "--frame", "robot"});
  EXPECT_EQ(text("m.csv"),
            "scan,angle_deg,range_m,time_ns\n0,170.000000,1.50025,0\n1,-10.500000,0.00000,7\n");
  convert("m.csv", "back.csv", {"--from-frame", "robot"});
  EXPECT_EQ(text("back.csv"), text("g4.csv"));
}

TEST_F(Convert, ColumnsAreFoundByTheirNames) {
  cli::write_file(path("own.csv"),
                  "range_m,intensity,angle_deg\r\n1.5,7,10\r\nno,7,11\r\n2,7,12\r\n");
  const outcome done = run({"convert", path("own.csv"), path("out.csv")});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(text("out.csv"),
            "scan,angle_deg,range_mm,time_ns,intensity\n0,10.000000,1500.00,0,7\n"
            "0,12.000000,2000.00,0,7\n");
  EXPECT_THAT(done.err, HasSubstr("2 points, 1 line without one: line 3 has no valid range_m\n"));
}

TEST_F(Convert, ToPointClouds) {
  raw("2");
  convert("raw.bin", "walk.csv");
  fs::create_directory(path("clouds"));
  convert("walk.csv", "clouds");
  convert("raw.bin", "scan-%04d.pcd", {"--ascii"});
  EXPECT_TRUE(fs::exists(path("clouds/scan-000000.pcd"))) << listing();
  EXPECT_THAT(text("scan-0000.pcd"), HasSubstr("\nDATA ascii\n"));
  const outcome one = run({"convert", path("raw.bin"), path("one.pcd")});
  EXPECT_EQ(one.code, 0);
  EXPECT_THAT(one.err, HasSubstr("OUT has the first whole revolution. For all of them"));
  EXPECT_THAT(text("one.pcd"), HasSubstr("\nDATA binary\n"));
}

TEST_F(Convert, PartOfARecording) {
  raw("6");
  convert("raw.bin", "part.csv", {"--from", "2s", "--to", "3s"});
  EXPECT_EQ(rows("part.csv").size(), 9001U);
  EXPECT_EQ(cli::number_in(rows("part.csv")[1], 3), 2'000'000'000);
  convert("raw.bin", "walk.csv");
  convert("walk.csv", "again.csv", {"--from", "2s", "--to", "3s"});
  EXPECT_EQ(text("again.csv"), text("part.csv"));
  convert("raw.bin", "walk.mcap");
  convert("walk.mcap", "part.csv", {"--from", "2s", "--to", "3s", "--force"});
  EXPECT_NEAR(static_cast<double>(rows("part.csv").size()), 9001.0, 200.0);
  convert("walk.mcap", "part.mcap", {"--from", "2s", "--to", "3s"});
  convert("part.mcap", "part.bin");
  convert("walk.mcap", "straight.bin", {"--from", "2s", "--to", "3s"});
  EXPECT_EQ(text("straight.bin"), text("part.bin"));
  EXPECT_NE(text("raw.bin").find(text("part.bin")), std::string::npos);
  convert("raw.bin", "cut.bin", {"--from", "2s", "--to", "3s"});
  EXPECT_NE(text("raw.bin").find(text("cut.bin")), std::string::npos);
  EXPECT_NEAR(static_cast<double>(text("cut.bin").size()), 20'380.0, 500.0);
}

TEST_F(Convert, DamagedRecording_IntactPartIsUsedAndDamageIsCounted) {
  raw("20");
  convert("raw.bin", "walk.mcap");
  const std::string good = text("walk.mcap");
  convert("walk.mcap", "good.csv");
  cli::write_file(path("cut.mcap"), good.substr(0, good.size() * 3 / 5));
  const outcome cut = run({"convert", path("cut.mcap"), path("cut.csv")});
  EXPECT_EQ(cut.code, 0) << cut.err;
  EXPECT_THAT(cut.err, HasSubstr("was cut off"));
  EXPECT_GT(rows("cut.csv").size(), rows("good.csv").size() / 2);
  EXPECT_EQ(text("good.csv").compare(0, text("cut.csv").size(), text("cut.csv")), 0);
  cli::write_file(path("bad.mcap"),
                  cli::damaged(good, cli::place_of_payload(good, text("raw.bin"))));
  const outcome bad = run({"convert", path("bad.mcap"), path("bad.csv")});
  EXPECT_EQ(bad.code, 0) << bad.err;
  EXPECT_THAT(bad.err, HasSubstr("1 chunk damaged"));
  EXPECT_GT(rows("bad.csv").size(), rows("good.csv").size() * 8 / 10);
  EXPECT_LT(rows("bad.csv").size(), rows("good.csv").size());
}

TEST_F(Convert, ImpossibleConversions_AreRefused) {
  raw("1");
  convert("raw.bin", "a.csv");
  expect_refused({path("a.csv"), path("b.mcap")}, 2, "holds points, not bytes of a lidar");
  expect_refused({path("a.csv"), path("b.bin")}, 2, "holds points, not bytes of a lidar");
  expect_refused({path("raw.bin"), path("b.mcap"), "--range", "1:2"}, 2, "are for points");
  expect_refused({path("raw.bin"), path("b.bin"), "--scans"}, 2, "are for points");
  expect_refused({path("raw.bin"), path("b.txt")}, 2, "does not end in .mcap");
  expect_refused({path("raw.bin"), "-"}, 2, "does not end in .mcap");
  expect_refused({path("raw.bin"), "-", "--to-format", "mcap"}, 2, "not to standard output");
  expect_refused({path("x.pcd"), path("b.csv")}, 10, "there is no file");
  expect_refused({path("raw.bin"), path("b.csv"), "--from-format", "pcd"}, 2, "is not one of");
  expect_refused({"sim:", path("b.csv")}, 2, "is not a file");
  expect_refused({path("none"), path("b.csv")}, 10, "there is no file");
  expect_refused({path("a.csv"), path("a.csv")}, 2,
                 "is also the input. Give another name for the output.");
  expect_refused({path("raw.bin"), path("none/b.csv")}, 10, "Make its directory first");
  expect_refused({path("raw.bin"), path("none/b.mcap")}, 10, "Make its directory first");
}

TEST_F(Convert, FilesWithoutUsableData_AreRefused) {
  cli::write_file(path("empty.bin"), "");
  cli::write_file(path("text.bin"), "dear reader of this file\n");
  cli::write_file(path("text.csv"), "dear\nfriend\n");
  cli::write_file(path("names.csv"), "scan,angle_deg,range_mm,time_ns\n");
  cli::write_file(path("strong.csv"), "angle_deg,range_mm,intensity\n10,500,strong\n");
  cli::write_file(path("text.jsonl"), "{}\n");
  cli::write_file(path("text.mcap"), "dear\n");
  expect_refused({path("empty.bin"), path("out.csv")}, 10, "is empty");
  expect_refused({path("text.bin"), path("out.csv")}, 10, "This is text");
  expect_refused({path("text.csv"), path("out.jsonl")}, 10, "no columns");
  expect_refused({path("names.csv"), path("out.jsonl")}, 10, "holds no points");
  expect_refused({path("strong.csv"), path("out.jsonl")}, 10,
                 "holds no points. Its line 2 has no valid intensity. Give");
  expect_refused({path("text.jsonl"), path("out.csv")}, 10, "holds no points");
  expect_refused({path("text.mcap"), path("out.csv")}, 10, "text.mcap");
  expect_refused({path("text.mcap"), path("out.bin")}, 10, "text.mcap");
  expect_refused({path("text.mcap"), path("out.mcap")}, 10, "text.mcap");
  expect_refused({path("text.bin"), path("out.mcap")}, 10, "This is text");
  expect_refused({path("text.bin"), path("out.csv"), "--from-format", "mcap"}, 10, "text.bin");
}

TEST_F(Convert, NothingToWrite_ReplacesNothing) {
  raw("3");
  convert("raw.bin", "walk.mcap");
  convert("raw.bin", "a.csv");
  cli::write_file(path("empty.bin"), "");
  cli::write_file(path("piece.bin"), text("raw.bin").substr(0, 2000));
  const std::vector<std::vector<std::string>> ranges{
      {"--from", "99s"}, {"--to", "0s"}, {"--from", "2s", "--to", "1s"}};
  const auto expect_kept = [&](const std::string& in, const std::string& out,
                               const std::vector<std::string>& more) {
    cli::write_file(path(out), "good");
    std::vector<std::string> words{"convert", path(in), path(out), "--force"};
    words.insert(words.end(), more.begin(), more.end());
    const outcome done = run(words);
    EXPECT_NE(done.code, 0) << in << out << done.err;
    EXPECT_EQ(cli::lines_of(done.err.substr(done.err.find("g4-dump: "))).size(), 1U) << done.err;
    EXPECT_EQ(text(out), "good") << in << out;
  };
  for (const std::string out : {"b.csv", "b.npy", "b.pcd", "b.bin", "b.mcap"}) {
    for (const auto& range : ranges) {
      for (const std::string in : {"raw.bin", "walk.mcap"}) expect_kept(in, out, range);
      if (out != "b.mcap" && out != "b.bin") expect_kept("a.csv", out, range);
    }
    expect_kept("empty.bin", out, {});
  }
  for (const std::string out : {"b.pcd", "b.carmen"}) expect_kept("piece.bin", out, {});
  expect_kept("raw.bin", "b.csv", {"--scans", "--from", "2990ms"});
  cli::write_file(path("old.mcap"), "good");
  EXPECT_EQ(run({"record", path("empty.bin"), "-o", path("old.mcap"), "--force"}).code, 10);
  EXPECT_EQ(text("old.mcap"), "good");
}

TEST_F(Convert, ARecordingThatIsCutBeforeItsPackets_NamesNoModel) {
  cli::record_in_virtual_time(path("walk.mcap"), 10);
  const std::string whole = text("walk.mcap");
  cli::write_file(path("cut.mcap"), whole.substr(0, whole.find("\xAA\x55") + 8));
  expect_refused({path("cut.mcap"), path("b.mcap")}, 10, "there is no whole packet in ");
  const outcome shown = run({"view", "--once", path("cut.mcap")});
  EXPECT_EQ(shown.code, 10);
  EXPECT_THAT(shown.err, HasSubstr("there is no whole packet in "));
}

TEST_F(Convert, LongFile_NeedsNoMoreMemoryThanAShortOne) {
  const std::string block = cli::zero(0) + cli::turn();
  cli::write_repeated(path("short.bin"), block, 1'000'000);
  cli::write_repeated(path("long.bin"), block, 6'000'000);
  for (const std::string length : {"short", "long"}) {
    convert(length + ".bin", length + ".mcap", {"--compress"});
    convert(length + ".bin", length + ".csv");
  }
  for (const std::string form : {".bin", ".mcap", ".csv"}) {
    for (const std::string to : {"csv", "jsonl"}) {
      const auto kib = [&](const std::string& length) {
        program started({"convert", path(length + form), "-", "--to-format", to},
                        {{}, stream::of_file("/dev/null"), {}});
        const outcome done = started.wait();
        EXPECT_EQ(done.code, 0) << done.err;
        return done.max_rss_kib;
      };
      EXPECT_LT(kib("long"), kib("short") + 2048) << form << " to " << to;
    }
  }
}

}  // namespace
