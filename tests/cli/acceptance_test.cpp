// SPDX-License-Identifier: MIT
// g4-dump acceptance as a person runs it: its page, its file, its questions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "acceptance/kit.hpp"
#include "program.hpp"
#include "support/patience.hpp"

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
  // An X4 Pro takes no commands: the run is short.
  program asked({"acceptance", "--json", "-d", "1s", "--file", file, "--model", "x4-pro",
                 "sim:?model=x4-pro&world=" + room});
  asked.feed("far\n800\ns\ns\n");
  asked.close_input();
  const outcome done = asked.wait();
  EXPECT_EQ(done.code, 0) << done.err << done.out;
  std::vector<json> steps;
  for (const std::string& line : lines_of(done.out)) steps.push_back(json::parse(line));
  ASSERT_EQ(steps.size(), g4_tool::acceptance::step_count);
  const json& near = steps.at(static_cast<std::size_t>(g4_tool::acceptance::step::near_target));
  EXPECT_EQ(near.at("evidence").at("placed_mm"), 800.0);
  EXPECT_EQ(near.at("verdict"), "agrees") << near;
  EXPECT_EQ(steps.back().at("verdict"), "not_done");
  const json& who = steps.at(static_cast<std::size_t>(g4_tool::acceptance::step::ct_information));
  EXPECT_EQ(who.at("evidence").at("number"), 4);
  EXPECT_THAT(done.err, HasSubstr("'far' is no distance"));
  EXPECT_THAT(done.err, HasSubstr("unplug"));

  const outcome played = run({"scan", "-n", "2", file});
  EXPECT_EQ(played.code, 0) << played.err;
  EXPECT_EQ(lines_of(played.out).size(), 3U) << played.out;  // a heading, and two scans
}

TEST_F(AcceptanceVerb, WithoutAModel_ItIsTheOneOfTheLidar) {
  const outcome done = run({"acceptance", "--alone", "-d", "500ms", "--file", path("x4.mcap"),
                            "sim:?model=x4&any_baud=true"});
  EXPECT_THAT(done.err, ::testing::HasSubstr("recognised: X4\n"));
  EXPECT_THAT(done.out, ::testing::HasSubstr("Compared with the X4 of the table of models:\n"));
  EXPECT_THAT(run({"info", path("x4.mcap")}).out, ::testing::HasSubstr("X4"));
  // Each question with its answer, or with the reason why it has none.
  const std::string page = in_one_line(done.out);
  EXPECT_THAT(page, HasSubstr(" yes With which number does the device identify itself? number 6"));
  EXPECT_THAT(page, HasSubstr(" open Does an edge of DTR start the motor, or its level? The "
                              "connection has no DTR."));
  EXPECT_THAT(page, HasSubstr(" - Is there power-down protection (D9)? Not with this model."));
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

/// A simulated T-mini at 10 Hz, in an own process, with its log.
class Settings : public AcceptanceVerb {
 protected:
  Settings()
      : served_({"sim", "--link", link_, "--model", "t-mini", "--log"},
                {cli::stream{}, cli::stream{}, cli::stream::of_file(log_)}) {
    EXPECT_TRUE(g4lidar::test::comes_true([&] { return std::filesystem::exists(link_); }));
  }

  /// The kit at work: it has changed the frequency.
  [[nodiscard]] std::unique_ptr<program> begun() {
    const std::size_t before = steps();
    auto asked = std::make_unique<program>(
        std::vector<std::string>{"acceptance", "--alone", "--model", "t-mini", "--file",
                                 path("t.mcap"), link_},
        cli::streams{cli::stream{}, cli::stream{}, cli::stream::of_file(messages_)});
    EXPECT_TRUE(g4lidar::test::comes_true([&] { return steps() > before; }));
    return asked;
  }

  [[nodiscard]] std::string messages() const { return cli::read_file(messages_); }
  /// By 1 Hz, upwards.
  [[nodiscard]] std::size_t steps() const {
    const auto lines = lines_of(cli::read_file(log_));
    return static_cast<std::size_t>(std::ranges::count_if(
        lines, [](const std::string& line) { return line.find("A5 0B") != std::string::npos; }));
  }
  [[nodiscard]] std::string frequency() const {
    return json::parse(run({"info", "--json", link_}).out).at("frequency").dump();
  }

  std::string link_ = path("lidar");
  std::string log_ = path("log");
  std::string messages_ = path("messages");
  program served_;
};

TEST_F(Settings, AreAsBefore_AfterASignal) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const auto asked = begun();
    asked->send(signal);
    const outcome done = asked->wait();
    EXPECT_EQ(done.code, 128 + signal) << messages();
    EXPECT_EQ(frequency(), "10.0") << messages();
    EXPECT_THAT(done.out, HasSubstr("Interrupted."));
    std::filesystem::remove(path("t.mcap"));
  }
}

TEST_F(Settings, OfALostLidar_TheCommandIsPrinted) {
  const auto asked = begun();
  served_.send(SIGKILL);
  const outcome done = asked->wait();
  EXPECT_EQ(done.code, 9) << messages();
  EXPECT_THAT(messages(), HasSubstr("g4-dump set --model t-mini '" + link_ + "' frequency=10\n"));
  EXPECT_EQ(messages().find("unplugged"), messages().rfind("unplugged")) << messages();
}

TEST_F(AcceptanceVerb, APortThatDoesNotExist_IsOneError) {
  for (const bool is_named : {false, true}) {
    std::vector<std::string> words{"acceptance", "--alone", "--file", path("no.mcap"),
                                   path("port")};
    if (is_named) words.insert(words.end(), {"--model", "g4"});
    const outcome done = run(words);
    EXPECT_EQ(done.code, 3) << done.err;
    EXPECT_EQ(lines_of(done.err).size(), 1U) << done.err;
    EXPECT_EQ(done.out, "");
    EXPECT_FALSE(std::filesystem::exists(path("no.mcap")));
  }
}

}  // namespace
