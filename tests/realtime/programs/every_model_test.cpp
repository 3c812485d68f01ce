// SPDX-License-Identifier: MIT
// The examples and the programs of the documents run with each model: they set nothing that a model may lack.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/core/model.hpp"

#include "realtime/child_process.hpp"
#include "realtime/device_on_pty.hpp"

namespace g4lidar::test {
namespace {

struct example {
  const char* program;
  /// What it prints before it gets a signal; null: it ends by itself.
  const char* running = nullptr;
  /// Whether it writes a file, its second argument.
  bool writes_file = false;
};

void run_with_each_model(const example& of) {
  struct run {
    std::string_view word;
    std::unique_ptr<child_process> program;
  };
  constexpr std::size_t together = 12;
  const scratch_directory directory;
  for (std::size_t begin = 0; begin < models.size(); begin += together) {
    std::vector<run> runs;
    for (std::size_t i = begin; i < std::min(begin + together, models.size()); ++i) {
      const std::string word(models[i].word);
      std::vector<std::string> words{of.program, "sim:?model=" + word};
      if (of.writes_file) words.push_back(directory.file(word + ".mcap"));
      runs.push_back(
          {models[i].word, std::make_unique<child_process>(words, directory.file(word))});
    }
    for (const run& each : runs) {
      if (of.running != nullptr) {
        EXPECT_TRUE(each.program->prints(of.running))
            << each.word << ": " << each.program->output();
        each.program->send(SIGTERM);
      }
      EXPECT_EQ(each.program->wait(), 0) << each.word << ": " << each.program->output();
    }
  }
}

TEST(EveryModel, RunsTheShortestProgram) { run_with_each_model({EXAMPLE_FIRST_SCAN}); }
TEST(EveryModel, RunsLiveScan) { run_with_each_model({EXAMPLE_LIVE_SCAN, "  3: "}); }
TEST(EveryModel, RunsTheEventLoop) { run_with_each_model({EXAMPLE_EVENT_LOOP, "scan 3: "}); }
#if defined(HAS_C_EXAMPLES)
TEST(EveryModel, RunsTheShortestProgramInC) { run_with_each_model({EXAMPLE_C_FIRST_SCAN}); }
TEST(EveryModel, RunsTheEventLoopInC) { run_with_each_model({EXAMPLE_C_EVENT_LOOP}); }
TEST(EveryModel, RunsTheRecorderInC) { run_with_each_model({EXAMPLE_C_RECORD, nullptr, true}); }
#endif

/// The lines of the complete programs of a page that open the lidar of their user.
std::vector<std::string> lines_of_programs(const std::string& page) {
  std::vector<std::string> lines;
  std::vector<std::string> block;
  bool is_in = false;
  std::ifstream text(page);
  EXPECT_TRUE(text) << page;
  for (std::string line; std::getline(text, line);) {
    if (!line.starts_with("```")) {
      if (is_in) block.push_back(line);
      continue;
    }
    const auto names_device = [](const std::string& each) {
      return each.find("words[1]") != std::string::npos ||
             each.find("sys.argv[1]") != std::string::npos;
    };
    if (is_in && std::ranges::any_of(block, names_device))
      lines.insert(lines.end(), block.begin(), block.end());
    block.clear();
    is_in = !is_in;
  }
  return lines;
}

TEST(EveryModel, ProgramsOfTheDocumentsSetNothing) {
  std::size_t count = 0;
  const std::string root = G4LIDAR_SOURCE_DIR;
  std::vector<std::string> pages{root + "/README.md"};
  for (const auto& each : std::filesystem::recursive_directory_iterator(root + "/docs")) {
    if (each.path().extension() == ".md") pages.push_back(each.path().string());
  }
  for (const std::string& page : pages) {
    for (const std::string& line : lines_of_programs(page)) {
      ++count;
      for (const char* const setting :
           {".frequency = ", "frequency_chz = ", "frequency_hz=", "sample_rate = ",
            "sample_rate_hz",
            "direction = ", "protection = ", ".idle = ", "low_power = ", "constant = "}) {
        EXPECT_EQ(line.find(setting), std::string::npos) << page << ": " << line;
      }
    }
  }
  EXPECT_GT(count, 60U);
}

}  // namespace
}  // namespace g4lidar::test
