// SPDX-License-Identifier: MIT
// What goes wrong: one clear sentence, the right exit code, and nothing half-written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "program.hpp"
#include "recording.hpp"

namespace {

using cli::outcome;
using cli::run;
using cli::run_on_full_disk;
using cli::stream;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class Failure : public cli::scratch {
 protected:
  // One line that begins with the name of the program and states what is wrong and what to do.
  static void expect_sentence(const outcome& done, int code, const std::string& what) {
    EXPECT_EQ(done.code, code);
    EXPECT_EQ(done.out, "");
    EXPECT_THAT(done.err, HasSubstr(what));
    const std::vector<std::string> lines = cli::lines_of(done.err);
    ASSERT_FALSE(lines.empty());
    EXPECT_THAT(lines.back(), StartsWith("g4-dump: "));
    EXPECT_THAT(done.err, EndsWith("\n"));
  }
  [[nodiscard]] std::string good() const {
    cli::write_file(path("good.bin"), cli::zero(0) + cli::turn());
    return path("good.bin");
  }
  // Runs it with -o out.csv twice, without and with an older file there: neither may change.
  void expect_nothing_written(std::vector<std::string> arguments,
                              std::uint64_t most_bytes = UINT64_MAX) {
    const std::string out = path("out.csv");
    arguments.insert(arguments.end(), {"-o", out});
    const std::string before = listing();
    EXPECT_NE(run_on_full_disk(most_bytes, arguments).code, 0);
    EXPECT_EQ(listing(), before);
    cli::write_file(out, "older\n");
    const std::string with_older = listing();
    EXPECT_NE(run_on_full_disk(most_bytes, arguments).code, 0);
    EXPECT_EQ(listing(), with_older);
    EXPECT_EQ(cli::read_file(out), "older\n");
  }
};

TEST_F(Failure, MissingFile) {
  expect_sentence(run({"decode", path("none.bin")}), 10,
                  "No such file or directory. Check the name");
  expect_nothing_written({"decode", path("none.bin")});
}

TEST_F(Failure, MissingRecording) {
  expect_sentence(run({"replay", path("none.mcap")}), 10, "none.mcap'. Check the name");
  expect_sentence(run({"replay", good()}), 10, "is not a recording. Give a file made by g4-dump");
}

TEST_F(Failure, DirectoryForAFile) {
  expect_sentence(run({"decode", directory_}), 10, "is a directory. Give a file");
  expect_nothing_written({"decode", directory_});
}

TEST_F(Failure, UnreadableFile) {
  if (::geteuid() == 0) GTEST_SKIP() << "nothing is unreadable for root";
  const std::string name = good();
  std::filesystem::permissions(name, std::filesystem::perms::none);
  expect_sentence(run({"decode", name}), 10, "Permission denied. You need permission");
}

TEST_F(Failure, EmptyInput) {
  cli::write_file(path("empty.bin"), "");
  expect_sentence(run({"decode", path("empty.bin")}), 10, "is empty. Give raw bytes");
  expect_sentence(run({"decode", "-"}), 10, "standard input is empty");
  expect_nothing_written({"decode", path("empty.bin")});
}

TEST_F(Failure, NoPacket) {
  cli::write_file(path("noise.bin"), std::string(500, '\xAA'));
  const outcome noise = run({"decode", path("noise.bin")});
  expect_sentence(noise, 10, "no point packet in the 500 bytes");
  EXPECT_THAT(noise.err, HasSubstr("wrong baud rate"));
  expect_nothing_written({"decode", path("noise.bin")});
  expect_sentence(run({"decode"}, "scan,angle_deg\n1,2\n"), 10, "This is text");
  expect_sentence(run({"decode"}, cli::scan_started()), 10, "the lidar was not scanning");
  for (const char* const format : {"csv", "jsonl", "text"}) {
    EXPECT_EQ(run({"decode", path("noise.bin"), "--format", format, "--scans"}).out, "");
  }
}

TEST_F(Failure, NoPacket_JsonStatsAreWritten) {
  const outcome done = run({"decode", "--stats", "json"}, std::string(500, '\x01'));
  EXPECT_EQ(done.code, 10);
  EXPECT_THAT(done.err, StartsWith(R"({"bytes":500,"packets":0,)"));
}

TEST_F(Failure, WrongCommandLine) {
  const auto expect_usage = [](const std::vector<std::string>& arguments, const std::string& what) {
    const outcome done = run(arguments, cli::zero(0));
    expect_sentence(done, 2, what);
    EXPECT_THAT(done.err, HasSubstr("See: g4-dump"));
    EXPECT_EQ(cli::lines_of(done.err).size(), 1U);
  };
  expect_usage({"help", "scam"}, "did you mean 'scan'? See: g4-dump --help");
  expect_usage({"encode"}, "unknown command 'encode'; commands are: list, watch, ");
  expect_usage({"--colour"},
               "unknown option '--colour'; did you mean '--color'? See: g4-dump dump --help");
  expect_usage({"decode", "--colour"},
               "unknown option '--colour'; did you mean '--color'? See: g4-dump decode --help");
  expect_usage({"decode", "--colour", "x", "y"}, "unknown option '--colour'");
  expect_usage({"decode", "one", "two", "three"}, "unexpected argument 'two'");
  expect_usage({"sim", "room.bin"}, "unexpected argument 'room.bin'");
  expect_usage({"decode", "a.bin", "b.bin"}, "unexpected argument 'b.bin'");
  expect_usage({"decode", "--format", "xml"}, "'xml' is not one of csv, jsonl, text");
  expect_usage({"decode", "--format"}, "--format");
  expect_usage({"decode", "--stats", "yaml"}, "'yaml' is not one of words, json");
  for (const char* const rate : {"0", "-9000", "fast", "1000001", "9000.5", ""}) {
    expect_usage({"decode", "--sample-rate", rate}, "--sample-rate");
  }
  expect_usage({"decode", "--sample-rate"}, "--sample-rate needs one value");
  expect_usage({"decode", "-n", "5", "-n", "6"}, "--count is given twice");
  expect_usage({"replay", "--verify", "--loop", "x"}, "--loop cannot be used with --verify");
  expect_usage({"set", "foo=3"}, "g4-dump: 'foo' is not one of sample_rate, frequency, ");
  expect_usage({"info", "--json=5"}, "--json takes no value. See: g4-dump info --help");
  expect_usage({"decode", "--quiet=no"}, "--quiet takes no value. See: g4-dump decode --help");
  for (const char* const seconds : {"-1", "long", "1e10", "nan", "inf"}) {
    expect_usage({"sim", "--seconds", seconds}, "--seconds");
  }
  for (const char* const seed : {"x", "-1", "1.5", "18446744073709551616", ""}) {
    expect_usage({"sim", "--seed", seed}, "--seed");
  }
  expect_usage({"sim", "--sample-rate", "5000"}, "'5000' is not one of 4000, 8000, 9000");
  expect_usage({"sim", "--frequency", "2"}, "--frequency");
  expect_usage({"sim", "--frequency", "4"}, "the scan frequency must be possible for the model");
  expect_usage({"sim", "--frequency", "nan"}, "--frequency");
  expect_usage({"sim", "--samples", "81"}, "1 to 80");
}

TEST_F(Failure, InvalidSource) {
  expect_sentence(run({"info", "serial:111"}), 2, "this does not name a lidar. ");
  expect_sentence(run({"info", "serial:111"}), 2, "Without SOURCE the only lidar is opened");
  expect_sentence(run({"dump", "sim"}), 2, "(did you mean sim:?)");  // no second command
}

TEST_F(Failure, WrongCommandLineTouchesNoFile) {
  expect_nothing_written({"decode", good(), "--sample-rate", "0"});
  expect_nothing_written({"sim", "--samples", "0"});
}

// No test gives a device by name while it is root: a mistake in the program could then replace the
// system's own device by a file.
TEST_F(Failure, StandardOutputIsFull) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full here";
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"decode", good()},
        {"sim", "--seconds", "1"},
        {"sim", "--seconds", "1", "-o", path("x"), "--truth", "-"},
        {"--help"},
        {"--version"},
        {"help"},
        {"scan", "--help"}}) {
    cli::program started(arguments, {{}, stream::of_file("/dev/full"), {}});
    expect_sentence(started.wait(), 10,
                    "cannot write standard output: No space left on device. Free some space");
  }
  EXPECT_EQ(listing(), "good.bin\n");
}

TEST_F(Failure, FullDevice) {
  if (::geteuid() == 0) GTEST_SKIP() << "not as root, who could replace the device by a file";
  expect_sentence(run({"decode", good(), "-o", "/dev/full"}), 10,
                  "cannot write '/dev/full': No space left on device");
  EXPECT_EQ(run({"decode", good(), "-o", "/dev/null"}).code, 0);
}

TEST_F(Failure, FileThatCannotGrow_IsRemoved) {
  const std::string name = path("good.bin");
  cli::write_repeated(name, cli::zero(0) + cli::turn(), 100'000);
  expect_sentence(run_on_full_disk(1000, {"decode", name, "-o", path("out.csv")}), 10,
                  "File too large. Free some space");
  expect_nothing_written({"decode", name}, 1000);
  expect_nothing_written({"sim", "--seconds", "5"}, 1000);
}

TEST_F(Failure, OutputHasNoDirectory) {
  expect_sentence(run({"decode", good(), "-o", path("none/out.csv")}), 10,
                  "No such file or directory. Make its directory first");
}

TEST_F(Failure, OutputIsADirectory) {
  expect_sentence(run({"decode", good(), "-o", directory_}), 10, "is a directory. Give the name");
}

TEST_F(Failure, StandardOutputIsClosed) {
  cli::program started({"decode", good()}, {{}, stream::none(), {}});
  const outcome done = started.wait();
  EXPECT_EQ(done.code, 10);
  EXPECT_THAT(done.err, HasSubstr("cannot write standard output"));
}

TEST_F(Failure, StandardErrorIsClosed_NoMessageIsInTheOutput) {
  const std::string name = good();
  const std::string all = run({"decode", name}).out;
  const std::vector<std::string> arguments{"decode", "-", "-o", path("out.csv")};
  cli::program started(arguments, {stream::of_file(name), {}, stream::none()});
  EXPECT_EQ(started.wait().code, 0);
  EXPECT_EQ(cli::read_file(path("out.csv")), all);
}

TEST_F(Failure, WorldFiles) {
  cli::write_file(path("world.txt"), "wall 1 1 2 2\nwindow 3 3\n");
  expect_sentence(run({"sim", "--world", path("world.txt")}), 10, "world.txt', line 2: ");
  expect_sentence(run({"sim", "--world", path("none.txt")}), 10, "No such file or directory");
  expect_sentence(run({"sim", "--world", directory_}), 10, "is a directory");
  expect_nothing_written({"sim", "--world", path("world.txt")});
}

TEST_F(Failure, ReplacedOutput_LeavesNoOtherFile) {
  const std::string name = good();
  const std::string all = run({"decode", name}).out;
  const std::string out = path("out.csv");
  cli::write_file(out, "older\n");
  ASSERT_EQ(::chmod(out.c_str(), 0640), 0);
  EXPECT_EQ(run({"decode", name, "-o", out, "--force"}).code, 0);
  EXPECT_EQ(cli::read_file(out), all);
  EXPECT_EQ(listing(), "good.bin\nout.csv\n");
  struct stat status{};
  ASSERT_EQ(::stat(out.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0640U) << "the older file's permissions stay";
}

TEST_F(Failure, OutOfMemoryIsNotABadFile) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer needs more addresses than may be limited";
#endif
  cli::write_repeated(path("turns.bin"), cli::zero(0) + cli::turn(), 2'000'000);
  bool seen = false;
  // Below some limit the loader fails, above another one nothing does.
  for (int kib = 6'000; kib <= 64'000 && !seen; kib += 100) {
    const std::string command = "ulimit -v " + std::to_string(kib) +
                                "; exec '" G4_DUMP "' decode '" + path("turns.bin") +
                                "' >/dev/null 2>'" + path("err") + "'";
    const int status = std::system(command.c_str());  // NOLINT(cert-env33-c): a limit for it alone
    if (!WIFEXITED(status)) continue;
    ASSERT_NE(WEXITSTATUS(status), 10) << cli::read_file(path("err"));
    seen = WEXITSTATUS(status) == 11;
  }
  ASSERT_TRUE(seen);
  EXPECT_EQ(cli::read_file(path("err")), "g4-dump: out of memory\n");
}

TEST(Help, IsOnStandardOutputAndHasExamples) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"decode", "--help"}, {"sim", "-h"}}) {
    const outcome done = run(arguments);
    EXPECT_EQ(done.code, 0);
    EXPECT_EQ(done.err, "");
    EXPECT_THAT(done.out, HasSubstr("Examples:\n  g4-dump " + arguments[0]));
    EXPECT_THAT(done.out, HasSubstr("Exit codes:"));
    for (const std::string& line : cli::lines_of(done.out)) EXPECT_LE(line.size(), 100U) << line;
  }
  EXPECT_THAT(run({"--help"}).out, HasSubstr("decode"));
  EXPECT_EQ(run({"help", "sim"}).out, run({"sim", "--help"}).out);
  EXPECT_EQ(run({"help"}).out, run({"--help"}).out);
}

TEST(Help, NamesEveryColumn) {
  const std::string help = run({"decode", "--help"}).out;
  const std::string recording = cli::zero(0);
  const std::string points = run({"decode"}, recording).out;
  const std::string scans = run({"decode", "--scans"}, recording).out;
  for (const std::string& csv : {points, scans}) {
    std::istringstream header(cli::lines_of(csv).at(0));
    for (std::string column; std::getline(header, column, ',');) {
      EXPECT_THAT(help, testing::ContainsRegex("[ (]" + column + "[ ,(\n]"));
    }
  }
}

TEST(Version, IsThatOfTheBuild) {
  const std::string expected = run({"--version"}).out;
  ASSERT_THAT(expected,
              testing::MatchesRegex("g4-dump [0-9.]+(~dev[0-9]+[+]g[0-9a-f]+ [(][-0-9]+[)])?\n"));
  const std::string number = expected.substr(8, expected.size() - 9);
  EXPECT_THAT(cli::read_file(G4LIDAR_VERSION_SOURCE),
              testing::HasSubstr(" = \"" + number + "\";\n"));
  EXPECT_EQ(run({"decode", "--version"}).out, expected);
  EXPECT_EQ(run({"--version"}).code, 0);
}

}  // namespace
