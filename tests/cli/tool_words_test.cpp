// SPDX-License-Identifier: MIT
// The tool names what its user can do: no word of the library's interface reaches them.
#include "cli/exit_code.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/error.hpp"

namespace {

using testing::HasSubstr;
using testing::Not;

std::vector<std::string> all_advice() {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < g4lidar::problem_count; ++i) {
    all.push_back(
        g4lidar::error(g4lidar::task::reading, static_cast<g4lidar::problem>(i)).message());
  }
  for (auto i = 0; i <= static_cast<int>(g4lidar::last_error_detail); ++i) {
    all.push_back(g4lidar::error(g4lidar::task::opening, g4lidar::problem::bad_option, {}, 0,
                                 static_cast<g4lidar::error_detail>(i))
                      .message());
  }
  for (std::size_t i = 0; i < g4lidar::diagnosis_count; ++i) {
    all.emplace_back(describe(static_cast<g4lidar::diagnosis>(i)).advice);
  }
  return all;
}

TEST(ToolWords, HaveNothingOfTheLibrarysInterface) {
  for (const std::string& advice : all_advice()) {
    const std::string words = g4_tool::in_tool_words(advice);
    for (const char* const word : {"()", "::", "_options", "reconnecting on", "open it again",
                                   "all again", "a default", "to be interrupted"}) {
      EXPECT_THAT(words, Not(HasSubstr(word)));
    }
  }
}

TEST(ToolWords, StandForWordsOfTheLibrary) {
  for (const g4_tool::tool_word& each : g4_tool::tool_words()) {
    EXPECT_THAT(all_advice(), testing::Contains(HasSubstr(std::string(each.library))));
  }
}

TEST(ToolWords, NameTheOptionsOfTheTool) {
  const g4lidar::error lost(g4lidar::task::reading, g4lidar::problem::gone, "/dev/ttyUSB0");
  EXPECT_EQ(g4_tool::in_tool_words(lost.message()),
            "reading /dev/ttyUSB0: the port is no longer there. Unless the program closed it, the "
            "lidar was unplugged: plug it in and run the command again; --on-loss reconnect waits "
            "for it.");
}

TEST(Evidence, IsWrittenWithoutAnExponent) {
  const auto text = [](double value) { return g4lidar::evidence{"rate_hz", value}.text(); };
  EXPECT_EQ(text(10'980.0), "10980");
  EXPECT_EQ(text(123'456.7), "123457");
  EXPECT_EQ(text(7.0), "7");
  EXPECT_EQ(text(7.0034), "7.003");
  EXPECT_EQ(text(11.394), "11.39");
  EXPECT_EQ(text(0.0), "0");
  EXPECT_EQ(text(0.86812), "0.8681");
  EXPECT_EQ(g4lidar::evidence({"count", std::int64_t{1'000'000}}).text(), "1000000");
  EXPECT_EQ(g4lidar::evidence({"path", std::string("/dev/ttyUSB0")}).text(), "/dev/ttyUSB0");
}

}  // namespace
