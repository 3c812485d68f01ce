// SPDX-License-Identifier: MIT
// The commands at ports of lidars of each kind, when nobody names the model.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "program.hpp"
#include "simulator.hpp"

namespace {

using cli::outcome;
using cli::run;
using cli::simulator;
using nlohmann::json;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

/// What is behind a port, by the manuals: not by the table of the library.
struct kind {
  std::string word;
  std::string name;
  bool is_scanning;         ///< A dead host has left it scanning.
  std::string others = {};  ///< Models that send the same.
};

const std::vector<kind>& kinds() {
  static const std::vector<kind> all{{"g4", "G4", false},
                                     {"x4", "X4", false},
                                     {"x2", "X2", false, "x2l, x3"},
                                     {"t-mini-pro", "T-mini Pro", false},
                                     {"tg15", "TG15", false},
                                     {"g2", "G2", true}};
  return all;
}

class UnnamedModel : public cli::scratch, public testing::WithParamInterface<kind> {
 protected:
  void serve(const std::string& word, bool is_scanning = false) {
    std::vector<std::string> options{"--model", word};
    if (is_scanning) options.insert(options.end(), {"--fault", "scanning"});
    served_.reset();
    served_ = std::make_unique<simulator>(port_, options);
  }
  void serve() { serve(GetParam().word, GetParam().is_scanning); }

  const std::string port_ = path("lidar");
  std::unique_ptr<simulator> served_;
};

TEST_P(UnnamedModel, InfoNamesItAndWhatSendsTheSame) {
  serve();
  const outcome done = run({"info", port_, "--json"});
  ASSERT_EQ(done.code, 0) << done.err;
  const json found = json::parse(done.out).at("lidar");
  EXPECT_EQ(found.at("model"), GetParam().word);
  EXPECT_EQ(found.at("candidates").front(), GetParam().word);
  EXPECT_EQ(found.at("candidates").size() > 1, !GetParam().others.empty()) << found;
  EXPECT_EQ(done.err.find(": was scanning and has been stopped") != std::string::npos,
            GetParam().is_scanning)
      << done.err;
  const outcome text = run({"info", port_});
  ASSERT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("\nmodel       " + GetParam().name));
  const std::string choice = " (or " + GetParam().others;
  EXPECT_EQ(text.out.find(choice) != std::string::npos, !GetParam().others.empty()) << text.out;
  EXPECT_EQ(text.err.find("--model names another one: " + GetParam().others) != std::string::npos,
            !GetParam().others.empty())
      << text.err;
}

INSTANTIATE_TEST_SUITE_P(Models, UnnamedModel, testing::ValuesIn(kinds()), [](const auto& of) {
  std::string name = of.param.word;
  std::erase(name, '-');
  return name;
});

/// Limits and errors.
class FoundModel : public UnnamedModel {};

TEST_F(FoundModel, StopOfALidarWithoutCommands_DoesNotClaimIt) {
  for (const auto& [word, state] : {std::pair{"x2", "it rests while no program has"},
                                    {"x4-pro", "its scan cannot be stopped"}}) {  // with its supply
    serve(word);
    std::vector<std::string> words{"stop", port_};
    if (std::string_view(word) == "x4-pro") words.insert(words.end(), {"--model", word});
    const outcome done = run(words);
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_THAT(done.err, HasSubstr(std::string(": this model has no commands: ") + state));
    EXPECT_THAT(done.err, Not(HasSubstr("it was not scanning")));
  }
}

TEST_F(FoundModel, HealthOfAOneWayLidar_IsThatOfItsCtBytes) {
  struct expectation {
    std::vector<std::string> device;
    int code;
    std::string_view out;
  };
  const std::vector<expectation> all{
      {{"ct_crc=true"}, 0, "status      ok\nerror_code  0\n"},
      {{"health=error"}, 8, "status      error\nerror_code  1\n"},
      {{"ct_crc=false", "health=error"}, 0, "status      unknown\nerror_code  unknown\n"},
      {{"ct_information=false"}, 0, "status      unknown\nerror_code  unknown\n"}};
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::vector<std::string> options{"--model", "x4-pro"};
    for (const std::string& each : all[i].device) {
      options.insert(options.end(), {"--device", each});
    }
    const std::string link = path("pro" + std::to_string(i));
    const simulator served(link, options);
    const outcome done = run({"health", link, "--model", "x4-pro"});
    EXPECT_EQ(done.code, all[i].code) << i << done.err;
    EXPECT_EQ(done.out, all[i].out) << i;
  }
  serve("x4-pro");
  const outcome as_json = run({"health", port_, "--model", "x4-pro", "--json"});
  EXPECT_EQ(json::parse(as_json.out).at("status"), "ok") << as_json.err;
  EXPECT_EQ(json::parse(as_json.out).at("error_code"), 0);
}

/// Several lidars at one computer.
class SeveralModels : public cli::scratch {
 protected:
  SeveralModels() {
    std::filesystem::create_directories(path("ports"));
    ::setenv("G4LIDAR_SIM_DIR", path("ports").c_str(), 1);
  }
  ~SeveralModels() override { ::unsetenv("G4LIDAR_SIM_DIR"); }
  void serve(const std::string& word) {
    const std::string link = path("ports/" + word);
    all_.push_back(std::make_unique<simulator>(link, std::vector<std::string>{"--model", word}));
  }

  std::vector<std::unique_ptr<simulator>> all_;
};

TEST_F(SeveralModels, ListNamesEach) {
  for (const char* const word : {"g4", "x2", "t-mini-pro", "x4"}) serve(word);
  const outcome done = run({"list", "--probe", "--json"});
  ASSERT_EQ(done.code, 0) << done.err;
  std::vector<std::string> found;
  std::string rest = done.out;
  for (std::size_t end = 0; (end = rest.find('\n')) != std::string::npos; rest.erase(0, end + 1)) {
    const json port = json::parse(rest.substr(0, end));
    if (port.at("driver") != "sim") continue;
    EXPECT_THAT(port.at("path").get<std::string>(),
                EndsWith("/" + port.at("lidar").at("model").get<std::string>()));
    found.push_back(port.at("lidar").at("model"));
  }
  EXPECT_THAT(found, ::testing::UnorderedElementsAre("g4", "x2", "t-mini-pro", "x4"));
}

TEST_F(SeveralModels, WithoutANameAllAreCounted) {
  serve("x4");
  const outcome only = run({"info", "--json"});
  ASSERT_EQ(only.code, 0) << only.err;
  EXPECT_EQ(json::parse(only.out).at("lidar").at("model"), "x4");
  serve("x2");
  const outcome both = run({"info"});
  EXPECT_NE(both.code, 0);
  EXPECT_THAT(both.err, HasSubstr("more than one lidar is connected"));
  EXPECT_THAT(both.err, HasSubstr("/x4"));
  EXPECT_THAT(both.err, HasSubstr("/x2"));
}

}  // namespace
