// SPDX-License-Identifier: MIT
// The words of users: labels of models, names of ports, what a model can be set to; and the table of models.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "program.hpp"

namespace {

using cli::outcome;
using cli::run;
using ::testing::HasSubstr;

/// The cells of a line: with two blanks or more, or with bars between them.
std::vector<std::string> cells_of(const std::string& line, const char* between) {
  const std::regex gap(between);
  std::vector<std::string> cells;
  for (std::sregex_token_iterator at(line.begin(), line.end(), gap, -1), end; at != end; ++at) {
    if (at->length() > 0) cells.push_back(*at);
  }
  return cells;
}

TEST(UserWords, ThePageOfTheModelsHasTheRowsOfTheTable) {
  const outcome listed = run({"list", "--models"});
  ASSERT_EQ(listed.code, 0) << listed.err;
  std::ifstream page(G4LIDAR_SOURCE_DIR "/docs/models.md");
  std::string line;
  while (std::getline(page, line) && !line.starts_with("| word | number |")) continue;
  std::istringstream rows(listed.out);
  std::size_t count = 0;
  for (std::string row; std::getline(rows, row); ++count) {
    std::erase(line, '`');
    EXPECT_EQ(cells_of(line, R"(\s*\|\s*)"), cells_of(row, "  +"))
        << "docs/models.md; see g4-dump list --models";
    std::getline(page, line);
    if (line.starts_with("|---")) std::getline(page, line);
  }
  EXPECT_EQ(count, 1 + std::size(g4lidar::models));
  EXPECT_EQ(line, "") << "a row that the table does not have";
}

TEST(UserWords, TheTableIsWrittenAsJson) {
  const outcome listed = run({"list", "--models", "--json"});
  EXPECT_EQ(listed.code, 0) << listed.err;
  EXPECT_THAT(listed.out,
              HasSubstr(R"({"word":"x4","number":"6","baud":"128000","samples per second":"5000",)"
                        R"("frequency in Hz":"pin M_SCTR","range in m":"0.12 to 10",)"));
}

}  // namespace
