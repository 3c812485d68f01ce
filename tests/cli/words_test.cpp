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
#include "support/family_reference.hpp"

namespace {

using cli::outcome;
using cli::run;
using ::testing::HasSubstr;
using ::testing::Not;

class UserWords : public cli::scratch {
 protected:
  UserWords() {
    const std::vector<std::uint8_t> bytes = reference::t_mini_stream(20);
    cli::write_file(raw_, std::string(bytes.begin(), bytes.end()));
  }
  const std::string raw_ = path("raw.bin");
};

TEST_F(UserWords, AProductThatIsNotSupportedIsNamed) {
  for (const auto& [product, why] :
       {std::pair<std::string, std::string>("GS2", "it has another protocol"),
        {"T30", "it has another protocol"},
        {"SDM15", "it has another protocol, usual driver YDLidar-SDK"},
        {"LD19", "a lidar of LDROBOT, usual driver ldlidar_stl_ros2"},
        {"rplidar-a1", "a lidar of Slamtec, usual driver sllidar_ros2"},
        {"OS30A", "a depth camera"},
        {"coin-d4", "read it as t-mini-pro with --listen (listen_only)"},
        {"HLS-LFCD2", "a lidar of Hitachi-LG, usual driver hls_lfcd_lds_driver"}}) {
    const std::string wanted = "'" + product + "' is not supported: " + why;
    for (const std::vector<std::string>& words :
         std::vector<std::vector<std::string>>{{"decode", raw_, "--model", product},
                                               {"doctor", raw_, "--model", product},
                                               {"decode", raw_, "--model", product + "!"},
                                               {"decode", "file:" + raw_ + "?model=" + product},
                                               {"scan", "sim:?model=" + product},
                                               {"sim", "--model", product}}) {
      const outcome done = run(words);
      EXPECT_EQ(done.code, 2) << words.front();
      EXPECT_THAT(done.err, HasSubstr(wanted)) << words.front();
      EXPECT_THAT(done.err, Not(HasSubstr("is not one of"))) << words.front();
    }
  }
}

TEST_F(UserWords, ANameOfAnotherKindHasTheRightOne) {
  for (const auto& [given, meant] :
       {std::pair("udp:0.0.0.0:8889", "tcp:0.0.0.0:8889"),
        std::pair("socket://h:4000", "tcp:h:4000"),
        std::pair("127.0.0.1:4000", "tcp:127.0.0.1:4000"), std::pair("ttyUSB0", "/dev/ttyUSB0"),
        std::pair("COM3", "/dev/ttyUSB0"), std::pair("/dev/ttyusb0", "/dev/ttyUSB0"),
        std::pair("USB0", "/dev/ttyUSB0")}) {
    const std::string wanted = std::string("did you mean ") + meant + "?";
    for (const char* const verb : {"scan", "info", "record", "set", "view", "acceptance"}) {
      std::vector<std::string> words{verb, given};
      if (words[0] == "set") words.emplace_back("frequency=10");
      if (words[0] == "record") words.push_back(path("o.mcap"));
      if (words[0] == "view") words.emplace_back("--once");
      const outcome done = run(words);
      EXPECT_EQ(done.code, 2) << verb << done.err;
      EXPECT_THAT(done.err, HasSubstr(wanted)) << verb;
    }
    const outcome examined = run({"doctor", given});
    EXPECT_EQ(examined.code, 3) << examined.err;
    EXPECT_THAT(std::regex_replace(examined.out, std::regex(R"(\s+)"), " "), HasSubstr(wanted));
    EXPECT_THAT(examined.out, HasSubstr("no_port"));
  }
  EXPECT_THAT(run({"scan", "udp:h:1"}).err, HasSubstr("not supported"));
}

TEST_F(UserWords, WhatAModelLacksIsDoneOtherwise) {
  const outcome x4 = run({"set", "sim:?model=x4", "frequency=10"});
  EXPECT_EQ(x4.code, 2) << x4.err;
  EXPECT_THAT(x4.err,
              HasSubstr("X4 (commands set nothing; its speed: voltage or PWM at pin M_SCTR)"));
  const outcome f4 = run({"set", "sim:?model=f4", "sample_rate=4k"});
  EXPECT_THAT(f4.err, HasSubstr("F4 (commands set frequency: 5 Hz to 12 Hz)"));
}

/// The cells of a line: with two blanks or more, or with bars between them.
std::vector<std::string> cells_of(const std::string& line, const char* between) {
  const std::regex gap(between);
  std::vector<std::string> cells;
  for (std::sregex_token_iterator at(line.begin(), line.end(), gap, -1), end; at != end; ++at) {
    if (at->length() > 0) cells.push_back(*at);
  }
  return cells;
}

TEST_F(UserWords, ThePageOfTheModelsHasTheRowsOfTheTable) {
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

TEST_F(UserWords, TheTableIsWrittenAsJson) {
  const outcome listed = run({"list", "--models", "--json"});
  EXPECT_EQ(listed.code, 0) << listed.err;
  EXPECT_THAT(listed.out,
              HasSubstr(R"({"word":"x4","number":"6","baud":"128000","samples per second":"5000",)"
                        R"("frequency in Hz":"pin M_SCTR","range in m":"0.12 to 10",)"));
}

}  // namespace
