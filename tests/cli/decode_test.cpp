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

// Whether each revolution of `recording` is partial, by its points in jsonl.
std::vector<bool> partial_scans(const std::string& recording) {
  std::vector<bool> partial;
  for (const std::string& line : lines_of(run({"decode", "--format", "jsonl"}, recording).out)) {
    const json point = json::parse(line);
    const auto scan = point.at("scan").get<std::size_t>();
    if (scan == partial.size()) partial.push_back(point.at("partial"));
    EXPECT_EQ(partial.at(scan), point.at("partial").get<bool>()) << "one revolution, two opinions";
  }
  return partial;
}

TEST(Decode, Jsonl_FlagsPartialRevolutions) {
  using seen = std::vector<bool>;
  const std::string whole = cli::zero(0) + cli::turn();
  EXPECT_EQ(partial_scans(whole + whole + cli::zero(0)), (seen{false, false, true}));
  EXPECT_EQ(partial_scans(cli::turn(4) + whole + cli::zero(0)), (seen{true, false, true}));
  // Noise is no loss: healthy devices send a stray byte before every zero packet.
  const std::string stray(1, '\0');
  EXPECT_EQ(partial_scans(whole + stray + whole + stray + cli::zero(0)),
            (seen{false, false, true}));
  // A damaged packet is one.
  const std::string hurt = cli::zero(0) + cli::damaged(cli::turn(), 100);
  EXPECT_EQ(partial_scans(whole + hurt + whole + cli::zero(0)), (seen{false, true, false, true}));
  // A packet whose first byte is damaged is one, too, though it counts as noise.
  const std::string headless = cli::zero(0) + cli::damaged(cli::turn(), 90);
  EXPECT_EQ(partial_scans(whole + headless + whole + cli::zero(0)),
            (seen{false, true, false, true}));
  // A suspect packet is one.
  const std::string suspect = cli::zero(0) + cli::turn() + cli::packet(359, 358, {4000, 4000});
  EXPECT_EQ(partial_scans(whole + suspect + whole), (seen{false, true, true}));
}

TEST(Decode, ScanNumber_GrowsWithEachZeroPacketExceptTheFirst) {
  const auto last_scan = [](const std::string& recording) {
    return fields_of(lines_of(run({"decode"}, recording).out).back()).front();
  };
  EXPECT_EQ(last_scan(cli::zero(0)), "0");
  EXPECT_EQ(last_scan(cli::zero(0) + cli::zero(0)), "1");
  EXPECT_EQ(last_scan(cli::turn() + cli::zero(0)), "1");
  EXPECT_EQ(last_scan("noise" + cli::zero(0)), "0");
  // CT with other bits set, but not the lowest, starts nothing.
  EXPECT_EQ(last_scan(cli::turn() + cli::packet(1, 2, {4000, 4000}, 0x86)), "0");
  // A suspect zero packet starts a revolution without a point.
  EXPECT_EQ(last_scan(cli::zero(0) + cli::packet(45, 44, {4000, 4000}, 1) + cli::turn()), "1");
}

TEST(Decode, TimeBeginsWithTheFirstPoint) {
  const std::string suspect = cli::packet(20, 19, {4000, 4000});
  const auto lines = lines_of(run({"decode"}, suspect + cli::packet(1, 2, {4000, 4000})).out);
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(fields_of(lines[1])[3], "0");
  EXPECT_EQ(fields_of(lines[2])[3], "111111");
}

TEST(Decode, TextOfASmallRecording) {
  const std::string text =
      "  scan  angle_deg   range_mm        time_s\n"
      "     0     342.01          -      0.000000\n"
      "     0     353.00     155.25      0.000111\n"
      "     0     349.24    1000.00      0.000222\n"
      "     0     351.08   16383.75      0.000333\n"
      "     1     356.42     280.00      0.000444\n"
      "     1     354.24    1000.00      0.000555\n"
      "     1     357.51          -      0.000666\n"
      "     1      18.55      75.00      0.000777  too near\n"
      "     2     352.01          -      0.001111\n";
  for (const words& each : {words{"decode", "--format", "text"}, {"dump", "-"}, {"-"}}) {
    EXPECT_EQ(run(each, small_recording()).out, text) << each[0];
  }
}

}  // namespace
