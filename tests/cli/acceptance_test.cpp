// SPDX-License-Identifier: MIT
// g4-dump acceptance as a person runs it: its page, its file, its questions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "g4lidar/diagnostics/acceptance.hpp"
#include "program.hpp"

namespace {

using cli::lines_of;
using cli::outcome;
using cli::program;
using cli::run;
using nlohmann::json;
using ::testing::HasSubstr;

class AcceptanceVerb : public cli::scratch {};

/// The words of a text, with single blanks between them.
std::string in_one_line(const std::string& text) {
  std::istringstream words(text);
  std::string line;
  for (std::string word; words >> word;) line += (line.empty() ? "" : " ") + word;
  return line;
}

// With a user who gives a wrong distance first, then a right one, and declines the rest.
TEST_F(AcceptanceVerb, AsksItsUser_AndWritesAFileThatReplays) {
  const std::string file = path("g4.mcap");
  // Straight ahead, which is opposite to the cable, is a wall; all others are farther.
  const std::string room = path("room.txt");
  std::ofstream(room) << "wall 4 -4 4 4\nwall 4 4 -0.8 4\nwall -0.8 4 -0.8 -4\nwall -0.8 -4 4 -4\n"
                      << "lidar 0 0 0\n";
  program asked({"acceptance", "--json", "-d", "1s", "--file", file, "sim:?world=" + room});
  asked.feed("far\n800\ns\ns\n");
  asked.close_input();
  const outcome done = asked.wait();
  EXPECT_EQ(done.code, 0) << done.err << done.out;
  std::vector<json> steps;
  for (const std::string& line : lines_of(done.out)) steps.push_back(json::parse(line));
  ASSERT_EQ(steps.size(), g4lidar::acceptance_step_count);
  const json& near = steps.at(static_cast<std::size_t>(g4lidar::acceptance_step::near_target));
  EXPECT_EQ(near.at("evidence").at("placed_mm"), 800.0);
  EXPECT_EQ(near.at("verdict"), "agrees") << near;
  EXPECT_EQ(steps.back().at("verdict"), "not_done");
  const json& who = steps.at(static_cast<std::size_t>(g4lidar::acceptance_step::identity));
  EXPECT_EQ(who.at("answers").at(0).at("state"), "answered");
  EXPECT_EQ(who.at("answers").at(0).at("text"), "With 5.");
  EXPECT_THAT(done.err, HasSubstr("'far' is no distance"));
  EXPECT_THAT(done.err, HasSubstr("unplug"));

  const outcome played = run({"scan", "-n", "2", file});
  EXPECT_EQ(played.code, 0) << played.err;
  EXPECT_EQ(lines_of(played.out).size(), 3U) << played.out;  // a heading, and two scans
}

TEST_F(AcceptanceVerb, AFileThatExists_IsNotReplaced) {
  const std::string file = path("g4.mcap");
  ASSERT_EQ(run({"record", "-d", "500ms", "-o", file, "sim:"}).code, 0);
  const auto size = std::filesystem::file_size(file);
  const outcome done = run({"acceptance", "--alone", "--file", file, "sim:"});
  EXPECT_EQ(done.code, 10) << done.err;
  EXPECT_EQ(std::filesystem::file_size(file), size);
}

TEST_F(AcceptanceVerb, WithoutAModel_ItIsTheOneOfTheLidar) {
  const outcome done = run({"acceptance", "--alone", "-d", "500ms", "--file", path("x4.mcap"),
                            "sim:?model=x4&any_baud=true"});
  EXPECT_THAT(done.err, ::testing::HasSubstr("recognised: X4\n"));
  EXPECT_THAT(done.out, ::testing::HasSubstr("Compared with the X4 of the table of models:\n"));
  EXPECT_THAT(run({"info", path("x4.mcap")}).out, ::testing::HasSubstr("X4"));
  // Each question with its answer, or with the reason why it has none.
  const std::string page = in_one_line(done.out);
  EXPECT_THAT(page, HasSubstr(" yes With which number does the device identify itself? With 6."));
  EXPECT_THAT(page, HasSubstr(" open Does an edge of DTR start the motor, or its level? The "
                              "connection has no DTR."));
  EXPECT_THAT(page, HasSubstr(" - Is there power-down protection (D9)? The model does not have"));
  EXPECT_THAT(page, HasSubstr(" open Are there time packets? There were none in less than 10 s."));
  EXPECT_THAT(page, HasSubstr(" open Is the unit of the range that of the table? There was no"));
  const outcome several =
      run({"acceptance", "--alone", "--file", path("x2.mcap"), "sim:?model=x2"});
  EXPECT_EQ(several.code, 2) << several.out;
  EXPECT_THAT(several.err, ::testing::HasSubstr("--model names one of x2, x2l, x3"));
  EXPECT_FALSE(std::filesystem::exists(path("x2.mcap")));
}

TEST_F(AcceptanceVerb, ARecording_IsRefused) {
  const std::string file = path("g4.mcap");
  ASSERT_EQ(run({"record", "-d", "500ms", "-o", file, "sim:"}).code, 0);
  const outcome done = run({"acceptance", "--file", path("other.mcap"), file});
  EXPECT_NE(done.code, 0);
  EXPECT_FALSE(std::filesystem::exists(path("other.mcap")));
}

}  // namespace
