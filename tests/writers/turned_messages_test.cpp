// SPDX-License-Identifier: MIT
// Messages and files of the scans of different models: the turn, the limits of the ranges and the number of bins.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "export/pcd.hpp"
#include "export/point_file.hpp"
#include "export/point_writer.hpp"
#include "export/slam_text.hpp"
#include "export/svg.hpp"
#include "export/text_points.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "support/cdr_reader.hpp"
#include "support/laser_scan.hpp"
#include "written.hpp"

namespace g4lidar::test {
namespace {

using namespace g4_tool;
using ::testing::ElementsAre;
using ::testing::FloatEq;
using ::testing::HasSubstr;

constexpr double pi = std::numbers::pi;

/// What is 2 m ahead of an X4, and 1 m to its left. A G4 would see it behind, and to the right.
const std::array<point, 2> points{{{.angle_deg = 0.0F, .range_mm = 2000.0F, .time_ns = 1000},
                                   {.angle_deg = 270.0F, .range_mm = 1000.0F, .time_ns = 4000}}};

scan scan_of(const char* name) { return {.points = points, .model = model_named(name)}; }

/// Whether a range is about there.
bool has(const laser_scan& read, double x, double y) {
  for (std::size_t i = 0; i < read.ranges.size(); ++i) {
    const auto angle = static_cast<double>(read.angle_min + static_cast<float>(i) * read.increment);
    const auto range = static_cast<double>(read.ranges[i]);
    if (std::hypot(range * std::cos(angle) - x, range * std::sin(angle) - y) < 1e-5) return true;
  }
  return false;
}

laser_scan read_scan(std::span<const float> ranges, const message_header& header) {
  std::vector<std::uint8_t> message;
  put_laser_scan(ranges, header, message);
  return read_laser_scan(message);
}

TEST(TurnedMessages, LaserScan_HasTheLimitsOfTheModel) {
  const std::array<float, 4> ranges{};
  const auto limits = [&](const char* name) {
    const laser_scan read = read_scan(ranges, {.model = model_named(name)});
    return std::array{read.range_min, read.range_max};
  };
  EXPECT_THAT(limits("g4"), ElementsAre(FloatEq(0.1F), FloatEq(16.0F)));
  EXPECT_THAT(limits("x4"), ElementsAre(FloatEq(0.12F), FloatEq(10.0F)));
  EXPECT_THAT(limits("g6"), ElementsAre(FloatEq(0.1F), FloatEq(25.0F)));
  EXPECT_THAT(limits("t-mini-pro"), ElementsAre(FloatEq(0.02F), FloatEq(12.0F)));
  EXPECT_THAT(limits("tg50"), ElementsAre(FloatEq(0.05F), FloatEq(50.0F)));
}

TEST(TurnedMessages, LaserScan_ByAngle) {
  std::vector<float> ranges(8);
  fill_grid(scan_of("x4"), ranges);
  const laser_scan ahead = read_scan(ranges, {.model = model_named("x4")});
  EXPECT_NEAR(ahead.angle_min, -pi, 1e-6);
  EXPECT_TRUE(has(ahead, 2.0, 0.0));
  EXPECT_TRUE(has(ahead, 0.0, 1.0));
  fill_grid(scan_of("g4"), ranges);
  const laser_scan behind = read_scan(ranges, {});
  EXPECT_TRUE(has(behind, -2.0, 0.0));
  EXPECT_TRUE(has(behind, 0.0, -1.0));
}

// In a frame with z down y is to the right.
TEST(TurnedMessages, LaserScan_ByTime) {
  std::vector<float> ranges(8);
  scan seen = scan_of("x4");
  seen.duration_ns = 4000;
  for (const std::size_t first : {0U, 3U, 4U, 7U}) {
    static_cast<void>(fill_time_grid(seen, ranges));
    const laser_scan ahead =
        read_scan(ranges, {.order = scan_order::time, .first_bin = first, .model = seen.model});
    EXPECT_GE(ahead.angle_min, -static_cast<float>(pi));
    EXPECT_LT(ahead.angle_min, static_cast<float>(pi));
    EXPECT_TRUE(has(ahead, 2.0, 0.0)) << first;
    EXPECT_TRUE(has(ahead, 0.0, -1.0)) << first;
    const laser_scan behind = read_scan(ranges, {.order = scan_order::time, .first_bin = first});
    EXPECT_TRUE(has(behind, -2.0, 0.0)) << first;
    EXPECT_TRUE(has(behind, 0.0, 1.0)) << first;
  }
}

TEST(TurnedMessages, TimeGrid_HasTheLongestRangeOfTheModel) {
  const std::array<point, 1> none{{{.angle_deg = 0.0F, .flags = point_flags::no_return}}};
  scan seen = scan_of("tg30");
  seen.points = none;
  std::array<float, 2> ranges{};
  static_cast<void>(fill_time_grid(seen, ranges, {.no_return = no_return_as::max}));
  EXPECT_FLOAT_EQ(ranges[0], 30.0F);
}

TEST(TurnedMessages, PointCloud2) {
  for (const auto& [name, side] : {std::pair{"x4", 1.0}, std::pair{"g4", -1.0}}) {
    std::vector<std::uint8_t> message;
    put_point_cloud2(points, {.model = model_named(name)}, message);
    // The data are 24 bytes for each point, before the flag is_dense.
    std::array<std::array<float, 6>, 2> rows{};
    std::memcpy(rows.data(), &message[message.size() - 1 - sizeof rows], sizeof rows);
    EXPECT_NEAR(rows[0][0], 2.0 * side, 1e-6);
    EXPECT_NEAR(rows[0][1], 0.0, 1e-6);
    EXPECT_NEAR(rows[1][0], 0.0, 1e-6);
    EXPECT_NEAR(rows[1][1], 1.0 * side, 1e-6);
    EXPECT_NEAR(rows[1][5], side * pi / 2, 1e-6);
  }
}

TEST(TurnedFiles, Pictures) {
  const auto svg = [](const char* name) {
    return written([&](text_sink& out) { write_svg(scan_of(name), out); });
  };
  EXPECT_THAT(svg("x4"), HasSubstr("M0 -200h0M-100 0h0"));  // up, and to the left
  EXPECT_THAT(svg("g4"), HasSubstr("M0 200h0M100 0h0"));
  EXPECT_EQ(written([&](text_sink& out) { write_svg(points, out, 0); }), svg("x4"));
}

TEST(TurnedFiles, Clouds) {
  const std::string xyz = written([](text_sink& out) {
    make_point_file_writer(point_file_format::xyz, frame::robot, *model_named("x4"))
        ->write_points(points, out);
  });
  double x = 0.0;
  double y = 0.0;
  ASSERT_EQ(std::sscanf(xyz.c_str(), "%lf %lf 0", &x, &y), 2);
  EXPECT_NEAR(x, 2.0, 1e-6);
  ASSERT_EQ(std::sscanf(xyz.c_str() + xyz.find('\n'), "%lf %lf 0", &x, &y), 2);
  EXPECT_NEAR(y, 1.0, 1e-6);
  const auto pcd = [](const char* name) {
    return written(
        [&](text_sink& out) { write_pcd(scan_of(name), frame::robot, pcd_data::ascii, out); });
  };
  EXPECT_THAT(pcd("x4"), HasSubstr(" 0 1 90 4000\n"));
  EXPECT_THAT(pcd("g4"), HasSubstr(" 0 1 -90 4000\n"));
}

TEST(TurnedFiles, PointsAsText_AndBack) {
  text_style style{.to = frame::robot, .turn_deg = 0};
  const std::string csv = written([&](text_sink& out) {
    const auto writer = make_point_writer(style);
    writer->begin(out);
    writer->write_points(points, out);
  });
  EXPECT_EQ(csv,
            "scan,angle_deg,range_mm,time_ns\n0,0.000000,2000.00,1000\n0,90.000000,1000.00,4000\n");
  point_lines lines(text_source::csv, frame::robot, *model_named("x4"));
  EXPECT_FALSE(lines.read("scan,angle_deg,range_mm,time_ns"));
  EXPECT_EQ(lines.read("0,90.000000,1000.00,4000")->point.angle_deg, 270.0F);
  EXPECT_EQ(lines.read("0,0,110,0")->point.flags, point_flags::too_near);
  EXPECT_EQ(lines.read("0,0,120,0")->point.flags, point_flags::none);
  // Revolutions have the turn of their model, whatever the style is.
  style = {.format = text_format::jsonl, .scans = true, .to = frame::robot};
  EXPECT_THAT(written([&](text_sink& out) {
                make_point_writer(style)->write_scan({.scan = scan_of("x4")}, out);
              }),
              HasSubstr("\"angle_deg\":[0.000000,90.000000]"));
}

TEST(TurnedFiles, RevolutionsOfText_HaveTheModel) {
  class taking final : public point_writer {
   public:
    [[nodiscard]] bool takes_scans() const noexcept override { return true; }
    void write_scan(const scan_record& record, text_sink&) override { model = record.scan.model; }
    const g4lidar::model* model = nullptr;
  };
  taking writer;
  static_cast<void>(written([&](text_sink& out) {
    text_points way(text_source::csv, frame::vendor, writer, out, *model_named("x2"));
    way.take("scan,angle_deg,range_mm,time_ns\n0,1,1000,0\n");
    way.finish();
  }));
  EXPECT_EQ(writer.model, model_named("x2"));
}

TEST(TurnedFiles, GridsAndLogs) {
  const auto grid = [](const char* name) {
    return written([&](text_sink& out) {
      make_grid_writer({.to = frame::robot}, 4)->write_scan({.scan = scan_of(name)}, out);
    });
  };
  EXPECT_THAT(grid("x4"), HasSubstr(",nan,nan,2000.00,1000.00\n"));
  EXPECT_THAT(grid("g4"), HasSubstr(",2000.00,1000.00,nan,nan\n"));
  const auto log = [](const char* name) {
    return written(
        [&](text_sink& out) { make_carmen_writer(4)->write_scan({.scan = scan_of(name)}, out); });
  };
  EXPECT_THAT(log("x4"), HasSubstr(" 30.00 0.01 0 4 30.00 30.00 2.0000 1.0000 "));
  EXPECT_THAT(log("tg30"), HasSubstr(" 66.00 0.01 0 4 2.0000 1.0000 66.00 66.00 "));
}

}  // namespace
}  // namespace g4lidar::test
