// SPDX-License-Identifier: MIT
// The output of the writers, compared with texts written by hand.
#include "export/point_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "export/pcd.hpp"
#include "written.hpp"

namespace g4lidar::test {
namespace {

using namespace g4_tool;
using nlohmann::json;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

point made(float angle_deg, float range_mm, std::int64_t time_ns, std::uint32_t revolution = 0) {
  point p{
      .angle_deg = angle_deg, .range_mm = range_mm, .time_ns = time_ns, .revolution = revolution};
  if (range_mm == 0.0F) p.flags = point_flags::no_return;
  if (range_mm > 0.0F && range_mm < 100.0F) p.flags = point_flags::too_near;
  return p;
}

// A return, no return, one that is too near, and odd times.
const std::vector<point> few{made(90.0F, 1234.5F, 1'000'000'007), made(180.0F, 0.0F, 0, 7),
                             made(270.5F, 75.25F, -1'500'000'000, 4'294'967'295)};

std::string points_as(const text_style& style, std::span<const point> points = few) {
  return written([&](text_sink& out) {
    const auto writer = make_point_writer(style);
    EXPECT_FALSE(writer->takes_scans());
    writer->begin(out);
    writer->write_points(points, out);
  });
}

/// `few` as one revolution.
scan_record whole_scan() {
  scan_record record;
  record.scan.points = few;
  record.scan.revolution = 12;
  record.scan.reported_frequency_chz = 700;
  record.scan.turned_deg = 359.987F;
  record.time_ns = 1'000'000'007;
  record.measured_hz = 7.0006;
  return record;
}

std::string scan_as(const text_style& style, const scan_record& record) {
  return written([&](text_sink& out) {
    const auto writer = make_point_writer(style);
    EXPECT_TRUE(writer->takes_scans());
    writer->begin(out);
    writer->write_scan(record, out);
  });
}

TEST(Csv, OfPoints) {
  EXPECT_EQ(points_as({}),
            "scan,angle_deg,range_mm,time_ns\n"
            "0,90.000000,1234.50,1000000007\n"
            "7,180.000000,0.00,0\n"
            "4294967295,270.500000,75.25,-1500000000\n");
}

// Without a return the direction is not tested here: it is that of the point.
TEST(Csv, InTheRobotsFrameAndMetres) {
  const std::vector<point> points{made(90.0F, 1234.5F, 5), made(0.0F, 16'383.75F, 6),
                                  made(180.0F, 0.25F, 7), made(359.5F, 100.0F, 8)};
  EXPECT_EQ(points_as({.to = frame::robot, .unit = length_unit::metres}, points),
            "scan,angle_deg,range_m,time_ns\n"
            "0,90.000000,1.23450,5\n"
            "0,-180.000000,16.38375,6\n"
            "0,0.000000,0.00025,7\n"
            "0,-179.500000,0.10000,8\n");
}

TEST(Csv, AngleThatRoundsToAFullTurn_IsZero) {
  const std::vector<point> points{made(std::nextafter(360.0F, 0.0F), 500.0F, 1)};
  EXPECT_EQ(points_as({}, points), "scan,angle_deg,range_mm,time_ns\n0,359.999969,500.00,1\n");
  EXPECT_THAT(points_as({.format = text_format::text}, points), HasSubstr("       0.00  "));
}

TEST(Csv, TheLargestTimes) {
  const std::vector<point> points{made(1.0F, 500.0F, std::numeric_limits<std::int64_t>::max()),
                                  made(1.0F, 500.0F, std::numeric_limits<std::int64_t>::min())};
  EXPECT_THAT(points_as({}, points), HasSubstr(",9223372036854775807\n"));
  EXPECT_THAT(points_as({}, points), EndsWith(",-9223372036854775808\n"));
}

// A point with values that the library does not produce is also written, in a row of its own.
TEST(Csv, ImpossibleNumbers_AreWritten) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float odd : {inf, -inf, nan, 1e30F, -1.0F, 100'000'000.0F, 720.0F}) {
    for (const text_format format : {text_format::csv, text_format::jsonl, text_format::text}) {
      for (const frame to : {frame::vendor, frame::robot}) {
        for (const length_unit unit : {length_unit::millimetres, length_unit::metres}) {
          const std::vector<point> points{made(odd, odd, 1), made(odd, 1.0F, 2)};
          const std::string text =
              points_as({.format = format, .to = to, .unit = unit, .as_they_come = true}, points);
          EXPECT_LT(text.size(), 400U);
        }
      }
    }
  }
}

// More than the buffer of the sink holds.
TEST(Csv, AnyNumberOfPoints) {
  std::vector<point> points;
  std::string expected = "scan,angle_deg,range_mm,time_ns\n";
  for (int i = 0; i < 20'000; ++i) {
    points.push_back(
        made(static_cast<float>(i % 360), 250.0F, i, static_cast<std::uint32_t>(i / 360)));
    expected += std::to_string(i / 360) + "," + std::to_string(i % 360) + ".000000,250.00," +
                std::to_string(i) + "\n";
  }
  EXPECT_EQ(points_as({}, points), expected);
  EXPECT_EQ(points_as({}, {}), "scan,angle_deg,range_mm,time_ns\n");
}

TEST(Csv, OfRevolutions) {
  EXPECT_EQ(scan_as({.scans = true}, whole_scan()),
            "scan,time_ns,points,returns,partial,why,turned_deg,reported_hz,measured_hz\n"
            "12,1000000007,3,2,false,,359.99,7.0,7.001\n");
  scan_record piece = whole_scan();
  piece.scan.flags = scan_flags::start_missing | scan_flags::data_lost;
  piece.scan.reported_frequency_chz = 0;
  piece.scan.turned_deg = -3.25F;
  piece.measured_hz = 0.0;
  piece.scan.points = {};
  EXPECT_THAT(scan_as({.scans = true}, piece),
              EndsWith("\n12,1000000007,0,0,true,start_missing+data_lost,-3.25,,\n"));
}

TEST(Jsonl, OfPointsAsTheyArrive) {
  EXPECT_EQ(points_as({.format = text_format::jsonl, .as_they_come = true}),
            R"({"scan":0,"angle_deg":90.000000,"range_mm":1234.50,"time_ns":1000000007,)"
            R"("no_return":false,"too_near":false})"
            "\n"
            R"({"scan":7,"angle_deg":180.000000,"range_mm":0.00,"time_ns":0,)"
            R"("no_return":true,"too_near":false})"
            "\n"
            R"({"scan":4294967295,"angle_deg":270.500000,"range_mm":75.25,"time_ns":-1500000000,)"
            R"("no_return":false,"too_near":true})"
            "\n");
}

// With all numbers as long as they can be.
TEST(Jsonl, OfPointsWithFlags_NamesThoseThatAreSet) {
  point p = made(359.999F, 99'999'999.0F, INT64_MIN, UINT32_MAX);
  p.flags = point_flags::not_deskewed | point_flags::unlikely | point_flags::isolated |
            point_flags::veiling | point_flags::may_be_too_near | point_flags::revolution_start;
  EXPECT_THAT(points_as({.format = text_format::jsonl, .as_they_come = true}, std::span(&p, 1)),
              EndsWith(R"("time_ns":-9223372036854775808,"no_return":false,"too_near":false,)"
                       R"("not_deskewed":true,"unlikely":true,"isolated":true,"veiling":true,)"
                       R"("may_be_too_near":true})"
                       "\n"));
  p.flags = point_flags::unlikely;
  EXPECT_THAT(points_as({.format = text_format::jsonl, .as_they_come = true}, std::span(&p, 1)),
              EndsWith(R"("too_near":false,"unlikely":true})"
                       "\n"));
}

TEST(Jsonl, OfPointsWithPartial) {
  scan_record record = whole_scan();
  record.scan.points = std::span(few).first(1);
  const text_style style{.format = text_format::jsonl, .unit = length_unit::metres};
  EXPECT_EQ(scan_as(style, record),
            R"({"scan":0,"angle_deg":90.000000,"range_m":1.23450,"time_ns":1000000007,)"
            R"("no_return":false,"too_near":false,"partial":false})"
            "\n");
  record.scan.flags = scan_flags::end_missing;
  EXPECT_THAT(scan_as(style, record), EndsWith("\"partial\":true}\n"));
}

TEST(Jsonl, OfRevolutions_IsValidJson) {
  scan_record record = whole_scan();
  record.scan.flags = scan_flags::turn_short | scan_flags::data_lost;
  record.scan.suspect_samples = 40;
  const json read = json::parse(scan_as({.format = text_format::jsonl, .scans = true}, record));
  EXPECT_EQ(read, json::parse(R"({"scan":12,"partial":true,"why":["data_lost","turn_short"],
      "points":3,"returns":2,"suspect_samples":40,"turned_deg":359.99,"reported_hz":7.0,
      "measured_hz":7.001,"angle_deg":[90,180,270.5],"range_mm":[1234.5,0,75.25],
      "time_ns":[1000000007,0,-1500000000]})"));
  record.scan.reported_frequency_chz = 0;
  record.measured_hz = 0.0;
  record.scan.points = {};
  const json empty = json::parse(scan_as({.format = text_format::jsonl, .scans = true}, record));
  EXPECT_TRUE(empty.at("reported_hz").is_null());
  EXPECT_TRUE(empty.at("measured_hz").is_null());
  EXPECT_EQ(empty.at("angle_deg").size(), 0U);
}

TEST(Text, OfPoints) {
  EXPECT_EQ(points_as({.format = text_format::text}),
            "  scan  angle_deg   range_mm        time_s\n"
            "     0      90.00    1234.50      1.000000\n"
            "     7     180.00          -      0.000000\n"
            "4294967295     270.50      75.25     -1.500000  too near\n");
  point p = few[2];
  p.flags = p.flags | point_flags::not_deskewed | point_flags::unlikely | point_flags::isolated |
            point_flags::veiling | point_flags::may_be_too_near;
  EXPECT_THAT(
      points_as({.format = text_format::text}, std::span(&p, 1)),
      EndsWith(
          " -1.500000  too near, not deskewed, unlikely, isolated, veiling, may be too near\n"));
}

TEST(Text, OfRevolutions) {
  const text_style style{.format = text_format::text, .scans = true};
  EXPECT_EQ(scan_as(style, whole_scan()),
            "  scan  points  returns  turned_deg  reported_hz  measured_hz  state\n"
            "    12       3        2      359.99          7.0         7.00  whole\n");
  scan_record piece = whole_scan();
  piece.scan.flags = scan_flags::start_missing | scan_flags::end_missing;
  piece.scan.reported_frequency_chz = 0;
  piece.measured_hz = 0.0;
  EXPECT_THAT(scan_as(style, piece),
              EndsWith("            -            -  partial: start_missing, end_missing\n"));
}

std::string grid_as(const text_style& style, const scan_record& record,
                    const grid_options& how = {}) {
  return written([&](text_sink& out) {
    const auto writer = make_grid_writer(style, 4, how);
    writer->begin(out);
    writer->write_scan(record, out);
  });
}

// Bins at 0, 90, 180 and 270 degrees: nothing measured, a return, and one too near to be reliable.
TEST(Grid, OfARevolution) {
  const std::vector<point> points{made(91.0F, 1234.5F, 3), made(269.0F, 75.25F, 4)};
  scan_record record = whole_scan();
  record.scan.points = points;
  EXPECT_EQ(grid_as({}, record),
            "scan,time_ns,partial,range_mm_0,range_mm_1,range_mm_2,range_mm_3\n"
            "12,1000000007,false,nan,1234.50,nan,nan\n");
  EXPECT_EQ(grid_as({.format = text_format::jsonl, .to = frame::robot, .unit = length_unit::metres},
                    record),
            R"({"scan":12,"partial":false,"time_ns":1000000007,"angle_min_deg":-180,)"
            R"("angle_step_deg":90,"ranges_m":[null,null,null,1.23450]})"
            "\n");
  EXPECT_EQ(grid_as({.format = text_format::text}, record),
            "  scan  4 ranges in mm\n"
            "    12  ? 1234.50 ? ?\n");
}

// A return, two directions without, of which something may be too near in one, and nothing measured.
TEST(Grid, WritesWhatDirectionsWithoutReturnBecome) {
  std::vector<point> points{made(1.0F, 1234.5F, 3), made(91.0F, 0.0F, 4), made(181.0F, 0.0F, 5)};
  points[1].flags = point_flags::no_return;
  points[2].flags = point_flags::no_return | point_flags::may_be_too_near;
  scan_record record = whole_scan();
  record.scan.points = points;
  const auto line_of = [&](text_format format, const grid_options& how) {
    const std::string all = grid_as({.format = format}, record, how);
    return all.substr(all.rfind('\n', all.size() - 2) + 1);
  };
  const grid_options max{.to = frame::robot,
                         .no_return = no_return_as::max};  // its frame is not used
  const grid_options minus{.near_is_minus_infinity = true};
  EXPECT_THAT(line_of(text_format::csv, {}), EndsWith("false,1234.50,inf,nan,nan\n"));
  EXPECT_THAT(line_of(text_format::csv, max), EndsWith("false,1234.50,16000.00,nan,nan\n"));
  EXPECT_THAT(line_of(text_format::csv, {.no_return = no_return_as::nan}),
              EndsWith("false,1234.50,nan,nan,nan\n"));
  EXPECT_THAT(line_of(text_format::csv, minus), EndsWith("false,1234.50,inf,-inf,nan\n"));
  EXPECT_THAT(line_of(text_format::jsonl, minus), EndsWith(R"([1234.50,"inf","-inf",null]})"
                                                           "\n"));
  EXPECT_THAT(line_of(text_format::text, minus), EndsWith(" 1234.50 - < ?\n"));
}

TEST(Pcd, Ascii_ContainsTheReturns) {
  const std::string cloud =
      written([](text_sink& out) { write_pcd(few, frame::vendor, pcd_data::ascii, out); });
  EXPECT_THAT(cloud, StartsWith("# .PCD v0.7 - Point Cloud Data file format\n"
                                "VERSION 0.7\n"
                                "FIELDS x y z range_m angle_deg time_ns\n"
                                "SIZE 4 4 4 4 4 8\n"
                                "TYPE F F F F F I\n"
                                "COUNT 1 1 1 1 1 1\n"
                                "WIDTH 2\n"
                                "HEIGHT 1\n"
                                "VIEWPOINT 0 0 0 1 0 0 0\n"
                                "POINTS 2\n"
                                "DATA ascii\n"));
  EXPECT_THAT(cloud, HasSubstr(" 1.2345 0 1.2345 90 1000000007\n"));
  EXPECT_THAT(cloud, EndsWith(" 0 0.07525 270.5 -1500000000\n"));
}

TEST(Pcd, Binary_IsLittleEndian) {
  const std::vector<point> points{made(0.0F, 1000.0F, 0x0102030405060708)};
  const std::string cloud =
      written([&](text_sink& out) { write_pcd(points, frame::vendor, pcd_data::binary, out); });
  const std::string expected(
      "\0\0\x80\x3F"
      "\0\0\0\0"
      "\0\0\0\0"
      "\0\0\x80\x3F"
      "\0\0\0\0"
      "\x08\x07\x06\x05\x04\x03\x02\x01",
      28);
  EXPECT_THAT(cloud, EndsWith("DATA binary\n" + expected));
  const std::string turned =
      written([&](text_sink& out) { write_pcd(points, frame::robot, pcd_data::ascii, out); });
  EXPECT_THAT(turned, HasSubstr("\n-1 "));
  EXPECT_THAT(turned, EndsWith(" 0 1 -180 72623859790382856\n"));
}

TEST(TextSink, PassesEverythingInOrder) {
  std::string all;
  std::size_t pieces = 0;
  callback_sink sink([&](std::string_view text) {
    all += text;
    ++pieces;
  });
  const std::string long_text(1'000'000, 'x');
  sink.write(long_text);
  EXPECT_TRUE(sink.has_unwritten());
  char* const at = sink.room(text_sink::max_room);
  *at = 'y';
  sink.wrote(at + 1);
  sink.flush();
  EXPECT_FALSE(sink.has_unwritten());
  EXPECT_EQ(all, long_text + "y");
  EXPECT_LE(pieces, 6U);
}

}  // namespace
}  // namespace g4lidar::test
