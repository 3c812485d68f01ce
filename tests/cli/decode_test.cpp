// SPDX-License-Identifier: MIT
// g4-dump decode: what it writes for bytes whose points are known.
#include <gtest/gtest.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "program.hpp"
#include "recording.hpp"

namespace {

using cli::lines_of;
using cli::outcome;
using cli::run;
using cli::small_recording;
using nlohmann::json;

// Its points: scan, angle by the formula in double precision, range and time as text.
struct expected_point {
  int scan;
  double angle_deg;
  std::string range_mm;
  std::string time_ns;
};
const std::vector<expected_point> small_points{
    {0, 342.009404, "0.00", "0"},         {0, 353.002590, "155.25", "111111"},
    {0, 349.237814, "1000.00", "222222"}, {0, 351.084181, "16383.75", "333333"},
    {1, 356.422734, "280.00", "444444"},  {1, 354.237814, "1000.00", "555555"},
    {1, 357.509404, "0.00", "666666"},    {1, 18.547194, "75.00", "777777"},
    {2, 352.009404, "0.00", "1111111"}};  // the two samples of the suspect packet took time

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',') {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

void expect_small_points(const std::string& csv) {
  const std::vector<std::string> lines = lines_of(csv);
  ASSERT_EQ(lines.size(), small_points.size() + 1);
  EXPECT_EQ(lines[0], "scan,angle_deg,range_mm,time_ns");
  for (std::size_t i = 0; i < small_points.size(); ++i) {
    SCOPED_TRACE(lines[i + 1]);
    const auto fields = fields_of(lines[i + 1]);
    ASSERT_EQ(fields.size(), 4U);
    EXPECT_EQ(fields[0], std::to_string(small_points[i].scan));
    EXPECT_NEAR(std::stod(fields[1]), small_points[i].angle_deg, 1e-4);
    EXPECT_TRUE(std::regex_match(fields[1], std::regex(R"((0|[1-9]\d{0,2})\.\d{6})")));
    EXPECT_EQ(fields[2], small_points[i].range_mm);
    EXPECT_EQ(fields[3], small_points[i].time_ns);
  }
}

using words = std::vector<std::string>;

TEST(Decode, CsvOfASmallRecording) {
  for (const words& each : {words{"decode", "-"}, {"dump", "-", "-f", "csv"}, {"-", "-f", "csv"}}) {
    SCOPED_TRACE(each[0]);
    const outcome done = run(each, small_recording());
    EXPECT_EQ(done.code, 0);
    expect_small_points(done.out);
  }
}

TEST(Decode, Default_IsCsvOfStandardInput) {
  const std::string all = run({"decode", "-", "--format", "csv"}, small_recording()).out;
  EXPECT_EQ(run({"decode"}, small_recording()).out, all);
  EXPECT_EQ(run({"decode", "--format=csv", "-o", "-"}, small_recording()).out, all);
}

TEST(Decode, Valid_LeavesOutPointsWithoutReturn) {
  const outcome done = run({"decode", "--valid"}, small_recording());
  const std::vector<std::string> lines = lines_of(done.out);
  ASSERT_EQ(lines.size(), 7U);
  for (const std::string& line : lines) EXPECT_EQ(line.find(",0.00,"), std::string::npos);
  EXPECT_TRUE(lines.back().ends_with(",75.00,777777"));  // times and scans stay as they are
}

TEST(Decode, JsonlOfASmallRecording) {
  const outcome done = run({"decode", "--format", "jsonl"}, small_recording());
  EXPECT_EQ(done.code, 0);
  const std::vector<std::string> lines = lines_of(done.out);
  ASSERT_EQ(lines.size(), small_points.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    SCOPED_TRACE(lines[i]);
    const json point = json::parse(lines[i]);
    EXPECT_EQ(point.size(), 7U);
    EXPECT_EQ(point.at("scan"), small_points[i].scan);
    EXPECT_NEAR(point.at("angle_deg").get<double>(), small_points[i].angle_deg, 1e-4);
    EXPECT_EQ(point.at("range_mm").get<double>(), std::stod(small_points[i].range_mm));
    EXPECT_EQ(point.at("time_ns").get<std::int64_t>(), std::stoll(small_points[i].time_ns));
    EXPECT_EQ(point.at("no_return"), small_points[i].range_mm == "0.00");
    EXPECT_EQ(point.at("too_near"), small_points[i].range_mm == "75.00");
    EXPECT_EQ(point.at("partial"), true);
  }
  EXPECT_EQ(lines[0], R"({"scan":0,"angle_deg":342.009399,"range_mm":0.00,"time_ns":0,)"
                      R"("no_return":true,"too_near":false,"partial":true})");
}

}  // namespace
