// SPDX-License-Identifier: MIT
// docs/errors.md, the enumeration, the names and the scenarios contain the same set; docs/symptoms.md has all events.
#include <gtest/gtest.h>

#include <cctype>
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

std::string text_of(const char* document) {
  const std::ifstream file(document);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string errors_document() { return text_of(G4LIDAR_ERRORS_DOCUMENT); }
std::string symptoms_document() { return text_of(G4LIDAR_SYMPTOMS_DOCUMENT); }

/// The sections that are named by one enumerator, and their text.
std::map<std::string, std::string> sections() {
  std::map<std::string, std::string> found;
  std::string* current = nullptr;
  std::istringstream lines(errors_document());
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

TEST(SymptomsDocument, HasALineForEachEvent) {
  const std::string text = symptoms_document();
  constexpr auto last = static_cast<std::size_t>(lidar_event::kind::other_number);
  for (std::size_t i = 0; i <= last; ++i) {
    const std::string name(name_of(static_cast<lidar_event::kind>(i)));
    EXPECT_NE(text.find("\n| `" + name + "` | "), std::string::npos) << name;
  }
}

/// The headings of a document, as links name them.
std::set<std::string> anchors_of(const std::string& text) {
  std::set<std::string> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("#")) continue;
    std::string name = line.substr(line.find(' ') + 1);
    for (char& letter : name) {
      letter =
          letter == ' ' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    }
    found.insert(name);
  }
  return found;
}

void expect_links(const std::string& text, const std::string& page, const std::string& target) {
  const std::set<std::string> anchors = anchors_of(target);
  const std::string begin = "](" + page + "#";
  std::size_t links = 0;
  for (std::size_t at = text.find(begin); at != text.npos; at = text.find(begin, at + 1)) {
    const std::size_t from = at + begin.size();
    EXPECT_TRUE(anchors.contains(text.substr(from, text.find(')', at) - from)))
        << text.substr(at, 60);
    ++links;
  }
  EXPECT_GT(links, 0U) << begin;
}

TEST(ErrorsDocument, LinksLeadToHeadings) {
  const std::string errors = errors_document();
  const std::string symptoms = symptoms_document();
  expect_links(errors, "", errors);
  expect_links(errors, "symptoms.md", symptoms);
  expect_links(symptoms, "", symptoms);
  expect_links(symptoms, "errors.md", errors);
}

}  // namespace
}  // namespace g4lidar::test
