// SPDX-License-Identifier: MIT
// What convert does with a file that is there already, and with a disk that is full; help and version on a full disk.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <filesystem>
#include <string>
#include <vector>

#include "program.hpp"

namespace {

using cli::outcome;
using cli::run;
using cli::stream;
using ::testing::HasSubstr;
using ::testing::Not;

class ConvertOutput : public cli::scratch {
 protected:
  void SetUp() override {
    ASSERT_EQ(run({"sim", "--seconds", "3", "-o", path("raw.bin")}).code, 0);
  }
};

TEST_F(ConvertOutput, ExistingFile_IsReplacedOnRequestOnly) {
  for (const std::string name : {"out.mcap", "out.bin", "out.csv", "out.npy", "out.carmen"}) {
    cli::write_file(path(name), "precious");
    const outcome refused = run({"convert", path("raw.bin"), path(name)});
    EXPECT_EQ(refused.code, 10) << name;
    EXPECT_THAT(refused.err, HasSubstr("it exists already. Give another name, or --force to "
                                       "replace it."));
    EXPECT_EQ(cli::read_file(path(name)), "precious");
    EXPECT_EQ(run({"convert", path("raw.bin"), path(name), "--force"}).code, 0) << name;
    EXPECT_GT(std::filesystem::file_size(path(name)), 1000U) << name;
  }
  EXPECT_EQ(run({"convert", path("raw.bin"), "-", "--to-format", "csv"}).code, 0);
}

TEST_F(ConvertOutput, ExistingFileOfARevolution_IsReplacedOnRequestOnly) {
  cli::write_file(path("scan-0001.pcd"), "precious");
  const std::vector<std::string> words{"convert", path("raw.bin"), path("scan-%04d.pcd")};
  const outcome refused = run(words);
  EXPECT_EQ(refused.code, 10);
  EXPECT_THAT(refused.err, HasSubstr("scan-0001.pcd': it exists already. Give another name, or "
                                     "--force"));
  EXPECT_EQ(cli::read_file(path("scan-0001.pcd")), "precious");
  std::vector<std::string> forced = words;
  forced.push_back("--force");
  EXPECT_EQ(run(forced).code, 0);
  EXPECT_THAT(cli::read_file(path("scan-0001.pcd")), Not(HasSubstr("precious")));
}

TEST_F(ConvertOutput, RecordingOnAFullDisk_IsRemovedAndTheErrorDoesNotPromiseIt) {
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit limit{20'000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &limit);
  const outcome done = run({"convert", path("raw.bin"), path("walk.mcap")});
  ::setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(done.code, 10);
  EXPECT_THAT(done.err, HasSubstr("walk.mcap': File too large. Free some space"));
  EXPECT_THAT(done.err, Not(HasSubstr("can be read")));
  EXPECT_THAT(done.err, Not(HasSubstr("digest"))) << "there is no file that has it";
  EXPECT_EQ(listing(), "raw.bin\n");
}

TEST(FullDisk, HelpAndVersion_AreErrors) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full here";
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--help"}, {"--version"}, {"help"}, {"scan", "--help"}}) {
    cli::program started(words, {{}, stream::of_file("/dev/full"), {}});
    const outcome done = started.wait();
    EXPECT_EQ(done.code, 10) << words[0];
    EXPECT_THAT(done.err, HasSubstr("cannot write standard output: No space left on device"));
  }
}

}  // namespace
