// SPDX-License-Identifier: MIT
// docs/errors.md, the enumeration, the names and the scenarios contain the same set.
#include <gtest/gtest.h>

#include <cstddef>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "g4lidar/lidar.hpp"
#include "scenario.hpp"

namespace g4lidar::test {
namespace {

std::string document() {
  const std::ifstream file(G4LIDAR_ERRORS_DOCUMENT);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The sections that are named by one enumerator, and their text.
std::map<std::string, std::string> sections() {
  std::map<std::string, std::string> found;
  std::string* current = nullptr;
  std::istringstream lines(document());
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("#")) {
      const std::string title = line.starts_with("## ") ? line.substr(3) : "";
      const bool is_word =
          !title.empty() && title.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == title.npos;
      current = is_word ? &found[title] : nullptr;
    } else if (current != nullptr) {
      current->append(line).append(" ");
    }
  }
  return found;
}

/// The end of a section: "*Fatal.* Shown by `One`, `Another`."
struct ending {
  std::string fatal;
  std::set<std::string> scenarios;
};

ending ending_of(const std::string& section) {
  ending found;
  const std::size_t shown = section.rfind(" Shown by ");
  if (shown == std::string::npos) return found;
  const std::size_t star = section.rfind('*', shown - 2);
  if (star != std::string::npos) found.fatal = section.substr(star, shown - star);
  std::istringstream rest(section.substr(shown));
  std::string word;
  while (std::getline(rest, word, '`') && std::getline(rest, word, '`')) {
    found.scenarios.insert(word);
  }
  return found;
}

TEST(ErrorsDocument, HasASectionForEachProblemAndNoOther) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < problem_count; ++i) {
    names.emplace(name_of(static_cast<problem>(i)));
  }
  EXPECT_EQ(names.size(), problem_count);
  std::set<std::string> titles;
  for (const auto& [title, text] : sections()) titles.insert(title);
  EXPECT_EQ(titles, names);
}

TEST(ErrorsDocument, NamesTheScenariosOfEachProblem) {
  std::map<std::string, std::set<std::string>> shown;
  for (const scenario& of : all_scenarios()) {
    shown[std::string(name_of(of.what))].emplace(of.name);
  }
  for (const auto& [title, text] : sections()) {
    EXPECT_EQ(ending_of(text).scenarios, shown[title]) << title;
  }
}

TEST(ErrorsDocument, StatesWhichProblemsAreFatal) {
  const auto all = sections();
  for (std::size_t i = 0; i < problem_count; ++i) {
    const auto what = static_cast<problem>(i);
    const auto section = all.find(std::string(name_of(what)));
    ASSERT_NE(section, all.end()) << name_of(what);
    const bool fatal = error(task::reading, what).is_fatal();
    EXPECT_EQ(ending_of(section->second).fatal, fatal ? "*Fatal.*" : "*Not fatal.*")
        << name_of(what);
  }
}

TEST(ErrorsDocument, HasALineForEachEvent) {
  const std::string text = document();
  constexpr auto last = static_cast<std::size_t>(lidar_event::kind::overflow);
  for (std::size_t i = 0; i <= last; ++i) {
    const std::string name(name_of(static_cast<lidar_event::kind>(i)));
    EXPECT_NE(text.find("\n| `" + name + "` | "), std::string::npos) << name;
  }
}

TEST(ErrorsDocument, LinksLeadToItsHeadings) {
  const std::string text = document();
  for (std::size_t at = text.find("](#"); at != text.npos; at = text.find("](#", at + 1)) {
    std::string title = text.substr(at + 3, text.find(')', at) - at - 3);
    for (char& letter : title) letter = letter == '-' ? ' ' : letter;
    if (title == "what happens by itself") title[0] = 'W';
    EXPECT_NE(text.find("# " + title + "\n"), std::string::npos) << title;
  }
}

}  // namespace
}  // namespace g4lidar::test
