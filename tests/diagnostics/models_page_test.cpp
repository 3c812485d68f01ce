// SPDX-License-Identifier: MIT
// The page of the models has each model and each open question, as the library has them.
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/diagnostics/acceptance.hpp"

namespace g4lidar::test {
namespace {

/// The cells of the row of the page that begins with this cell.
std::vector<std::string> row_of(const std::string& first) {
  std::ifstream page(std::string(G4LIDAR_SOURCE_DIR) + "/docs/models.md");
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with("| " + first + " |")) continue;
    std::vector<std::string> cells;
    std::istringstream words(line.substr(1));
    for (std::string cell; std::getline(words, cell, '|');) {
      if (cell.size() > 2) cells.push_back(cell.substr(1, cell.size() - 2));
    }
    return cells;
  }
  return {};
}

std::string baud_words(const model& of) {
  std::string text = std::to_string(of.bauds[0]);
  if (of.bauds[1] != 0) text += ", " + std::to_string(of.bauds[1]);
  return text;
}

TEST(ModelsPage, HasEachModelWithItsEvidence) {
  constexpr std::array<std::string_view, 4> words{"recorded", "agreed", "one source", "none"};
  for (const model& each : models) {
    const auto row = row_of("`" + std::string(each.word) + "`");
    ASSERT_EQ(row.size(), 7U) << each.word;
    EXPECT_TRUE(row[1].starts_with(each.name)) << each.word;
    EXPECT_EQ(row[2], baud_words(each)) << each.word;
    const bool is_two_way = each.link == link_kind::two_way;
    EXPECT_EQ(row[3], is_two_way ? "two-way" : "one-way") << each.word;
    const std::string motor = each.motor == motor_kind::command ? "commands"
                              : each.motor == motor_kind::dtr   ? "DTR"
                                                                : "supply";
    EXPECT_EQ(row[4], motor) << each.word;
    EXPECT_NE(std::ranges::find(words, row[5]), words.end()) << each.word;
    const bool is_word = std::ranges::find(words, row[6]) != words.end();
    EXPECT_EQ(is_word && is_two_way, is_two_way) << each.word;
  }
}

TEST(ModelsPage, HasEachOpenQuestionWithItsStep) {
  for (const open_question& each : open_questions()) {
    const auto row = row_of(std::string(each.text));
    ASSERT_EQ(row.size(), 2U) << each.text;
    EXPECT_EQ(row[1], "`" + std::string(name_of(each.step)) + "`");
  }
}

}  // namespace
}  // namespace g4lidar::test
