// SPDX-License-Identifier: MIT
// g4-dump sim: bytes that decode understands, the truth beside them, and the options' effect.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "program.hpp"

namespace {

using cli::lines_of;
using cli::outcome;
using cli::run;
using nlohmann::json;

std::vector<double> numbers_of(const std::string& line) {
  std::vector<double> numbers;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) numbers.push_back(std::stod(field));
  return numbers;
}

class Sim : public cli::scratch {
 protected:
  // Its bytes with these options.
  std::string bytes_of(std::vector<std::string> options) {
    options.insert(options.begin(), "sim");
    options.insert(options.end(), {"-o", path("x.bin"), "--force"});
    const outcome done = run(options);
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(done.out, "");
    EXPECT_EQ(done.err, "");
    return cli::read_file(path("x.bin"));
  }
  static json stats_of(const std::string& bytes) {
    return json::parse(run({"decode", "--stats", "json", "--valid"}, bytes).err);
  }
};

TEST_F(Sim, OptionsReachTheScanner) {
  const auto points = [&](std::vector<std::string> options) {
    options.insert(options.end(), {"--seconds", "2"});
    return stats_of(bytes_of(options)).at("points").get<double>();
  };
  EXPECT_NEAR(points({"--sample-rate", "4000"}), 8'000, 40);
  EXPECT_NEAR(points({"--sample-rate", "8000"}), 16'000, 40);
  EXPECT_NEAR(points({"--samples", "80"}), 18'000, 80);
  const auto scans = [&](std::vector<std::string> options) {
    options.insert(options.end(), {"--seconds", "2", "--start-deg", "90"});
    return run({"decode", "--scans", "--format", "jsonl"}, bytes_of(options)).out;
  };
  EXPECT_EQ(json::parse(lines_of(scans({"--frequency", "12"})).at(1)).at("reported_hz"), 12.0);
  EXPECT_NEAR(
      json::parse(lines_of(scans({"--frequency", "5.5"})).at(1)).at("measured_hz").get<double>(),
      5.5, 0.05);
  EXPECT_TRUE(
      json::parse(lines_of(scans({"--no-reported-frequency"})).at(1)).at("reported_hz").is_null());
  const std::string clean = bytes_of({"--seconds", "2"});
  for (const std::vector<std::string>& flaw : {std::vector<std::string>{"--noise-mm", "5"},
                                               {"--noise-ratio", "0.01"},
                                               {"--dropout", "0.1"},
                                               {"--index-deg", "348"},
                                               {"--start-deg", "10"}}) {
    std::vector<std::string> options{"--seconds", "2"};
    options.insert(options.end(), flaw.begin(), flaw.end());
    EXPECT_NE(bytes_of(options), clean) << flaw[0];
  }
  const std::string blind = bytes_of({"--seconds", "2", "--dropout", "1"});
  EXPECT_EQ(lines_of(run({"decode", "--valid"}, blind).out).size(), 1U) << "the header alone";
}

TEST_F(Sim, AWorldFromAFile) {
  // A square room of 4 m, the lidar in its middle.
  cli::write_file(path("room.txt"),
                  "# a room\nlidar 0 0 0\nwall -2 -2 2 -2\nwall 2 -2 2 2\nwall 2 2 -2 2\n"
                  "wall -2 2 -2 -2\n");
  bytes_of({"--seconds", "1", "--world", path("room.txt"), "--truth", path("truth.csv")});
  const std::vector<std::string> truth = lines_of(cli::read_file(path("truth.csv")));
  ASSERT_GT(truth.size(), 8'900U);
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const double range_mm = numbers_of(truth[i])[5];
    ASSERT_GE(range_mm, 1999.999) << truth[i];
    ASSERT_LE(range_mm, 2828.428) << truth[i];
  }
}

TEST_F(Sim, APathFromAFile) {
  cli::write_file(path("way.txt"), "drive forward 2 0.5\n");
  bytes_of({"--seconds", "5", "--path", path("way.txt"), "--truth", path("truth.csv"), "--odometry",
            path("way.odo"), "--way-slip", "0.1", "--odometry-rate", "10"});
  const std::vector<double> last = numbers_of(lines_of(cli::read_file(path("truth.csv"))).back());
  EXPECT_NEAR(last[7], 0.0, 1e-6);
  EXPECT_NEAR(last[8], 2.0, 1e-6) << "the lidar of the built-in world looks up";
  EXPECT_NEAR(last[9], 90.0, 1e-6);
  const std::vector<std::string> odometry = lines_of(cli::read_file(path("way.odo")));
  ASSERT_EQ(odometry.size(), 50U);
  EXPECT_EQ(odometry.front(), "0 0.000000 0.000000 0.000000");
  EXPECT_EQ(odometry.back(), "4900000000 2.200000 0.000000 0.000000");
}

TEST_F(Sim, OptionsOfTheOdometryWithoutIt_AreRefused) {
  for (const std::string option :
       {"--odometry-rate", "--way-noise", "--turn-noise", "--way-slip", "--turn-slip"}) {
    for (const std::vector<std::string>& where :
         {std::vector<std::string>{"-o", path("x.bin")}, {"--link", path("lidar")}}) {
      std::vector<std::string> words{"sim", option, "0.2"};
      words.insert(words.end(), where.begin(), where.end());
      const outcome done = run(words);
      EXPECT_EQ(done.code, 2) << option;
      EXPECT_THAT(done.err, testing::HasSubstr(option));
      EXPECT_THAT(done.err, testing::HasSubstr("need --odometry"));
    }
  }
  EXPECT_EQ(listing(), "");
}

TEST_F(Sim, AWrongPathNamesItsLine) {
  cli::write_file(path("way.txt"), "drive forward 2\npose 1 1 1 1\n");
  const auto result = run({"sim", "--path", path("way.txt"), "-o", path("x.bin")});
  EXPECT_EQ(result.code, 10);
  EXPECT_THAT(result.err,
              testing::HasSubstr("line 2: a path has lines 'pose' or lines 'drive', not both"));
}

}  // namespace
