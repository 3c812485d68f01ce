// SPDX-License-Identifier: MIT
// A signal ends each command that reads a file, also where a small one unpacks to much, or a large one has no packet.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "program.hpp"
#include "support/hostile_mcap.hpp"

namespace {

using namespace std::chrono_literals;
using g4lidar::test::hostile_chunk;
using g4lidar::test::hostile_mcap;
using g4lidar::test::slow_mcap;

class InterruptedFile : public cli::scratch, public ::testing::WithParamInterface<const char*> {
 protected:
  std::vector<std::string> command(const std::string& file) const {
    std::vector<std::string> words{GetParam(), file};
    if (words[0] == "convert") words.push_back(path("out.csv"));
    if (words[0] == "record") words.push_back(path("out.mcap"));
    return words;
  }
  void expect_end_of(const std::string& file) const {
    cli::program reading(command(file));
    std::this_thread::sleep_for(1s);
    reading.send(SIGTERM);
    const auto begin = std::chrono::steady_clock::now();
    const auto ended = reading.wait();
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 20s);
    EXPECT_EQ(ended.code == -1 ? -ended.signal : ended.code, 128 + SIGTERM) << ended.err;
  }
};

TEST_P(InterruptedFile, ObeysASignal) {
  cli::write_file(path("slow.mcap"), slow_mcap());
  expect_end_of(path("slow.mcap"));  // it needs a minute
}

TEST_P(InterruptedFile, FileOfZerosThatUnpacksToMuch_EndsByItself) {
  cli::write_file(path("zeros.mcap"), hostile_mcap(hostile_chunk(), 1'000));
  const auto begin = std::chrono::steady_clock::now();
  const auto ended = cli::run(command(path("zeros.mcap")));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 30s) << "it unpacks to 64 GiB";
  EXPECT_EQ(ended.code, 10) << ended.err;
}

// A sparse file: no packet in it ends the reading.
TEST_P(InterruptedFile, LargeFileWithoutPackets_ObeysASignal) {
  const std::string command_name = GetParam();
  if (command_name == "replay" || command_name == "info") return;  // they refuse raw bytes
  cli::write_file(path("zeros.bin"), "");
  std::filesystem::resize_file(path("zeros.bin"), std::uintmax_t{1} << 38U);
  expect_end_of(path("zeros.bin"));  // it needs hours
}

INSTANTIATE_TEST_SUITE_P(Commands, InterruptedFile,
                         ::testing::Values("stats", "scan", "dump", "packets", "convert", "record",
                                           "replay", "info", "doctor"));

}  // namespace
