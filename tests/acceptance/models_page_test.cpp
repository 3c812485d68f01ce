// SPDX-License-Identifier: MIT
// The page of the models has each model and each open question, as the library has them.
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "acceptance/kit_rows.hpp"
#include "g4lidar/core/model.hpp"

namespace g4_tool::acceptance::test {
namespace {

/// The cells of a row of a table.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream words(line.substr(1));
  for (std::string cell; std::getline(words, cell, '|');) {
    if (cell.size() > 2) cells.push_back(cell.substr(1, cell.size() - 2));
  }
  return cells;
}

/// The cells of the row of the page that begins with this cell.
std::vector<std::string> row_of(const std::string& first) {
  std::ifstream page(std::string(G4LIDAR_SOURCE_DIR) + "/docs/models.md");
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("| " + first + " |")) return cells_of(line);
  }
  return {};
}

/// The names in the first table of the README, each with the last cell of its row.
std::map<std::string, std::string> evidence_in_readme() {
  std::map<std::string, std::string> all;
  std::ifstream page(std::string(G4LIDAR_SOURCE_DIR) + "/README.md");
  std::string line;
  while (std::getline(page, line) && !line.starts_with("| lidar ")) continue;
  while (std::getline(page, line) && line.starts_with("|")) {
    const auto cells = cells_of(line);
    if (cells.size() != 3 || line.starts_with("|-")) continue;
    // Without the links to pages.
    std::istringstream names(
        std::regex_replace(cells[0], std::regex(R"(\[([^\]]*)\]\([^)]*\))"), "$1"));
    for (std::string name; std::getline(names >> std::ws, name, ',');) all[name] = cells[2];
  }
  return all;
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

TEST(ModelsPage, TheReadmeHasTheSameEvidence) {
  const auto readme = evidence_in_readme();
  EXPECT_EQ(readme.size(), std::size(models));
  for (const model& each : models) {
    const auto found = readme.find(std::string(each.name));
    ASSERT_NE(found, readme.end()) << each.name;
    EXPECT_EQ(found->second, row_of("`" + std::string(each.word) + "`").at(5)) << each.name;
  }
}

TEST(ModelsPage, HasEachOpenQuestionWithItsStep) {
  for (const question_row& each : question_rows()) {
    const auto row = row_of(std::string(each.text));
    ASSERT_EQ(row.size(), 2U) << each.text;
    EXPECT_EQ(row[1], "`" + std::string(name_of(each.asked_by)) + "`");
  }
}

}  // namespace
}  // namespace g4_tool::acceptance::test
