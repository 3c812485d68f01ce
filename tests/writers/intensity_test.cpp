// SPDX-License-Identifier: MIT
// The intensity of returns in grids, ROS messages and point clouds: only where it is asked for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "export/pcd.hpp"
#include "export/point_file.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "support/cdr_reader.hpp"
#include "support/laser_scan.hpp"
#include "written.hpp"

namespace g4lidar::test {
namespace {

using namespace g4_tool;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

/// In a grid of four bins of the vendor's frame: a farther and a nearer return, one without a return,
/// nothing, and one that is too near.
const std::array<point, 4> four{
    {{.angle_deg = 1.0F, .range_mm = 2000.0F, .time_ns = 10, .intensity = 300},
     {.angle_deg = 30.0F, .range_mm = 1000.0F, .time_ns = 20, .intensity = 65'535},
     {.angle_deg = 90.0F, .time_ns = 30, .flags = point_flags::no_return},
     {.angle_deg = 270.0F,
      .range_mm = 50.0F,
      .time_ns = 40,
      .flags = point_flags::too_near,
      .intensity = 9}}};

TEST(Intensity, OfAGridIsThatOfThePointWithTheRange) {
  std::array<float, 4> ranges_m{};
  std::array<float, 4> intensities{1.0F, 1.0F, 1.0F, 1.0F};
  grid_options how{.to = frame::vendor};
  fill_grid(four, ranges_m, how, intensities);
  EXPECT_EQ(ranges_m[0], 2.0F);
  EXPECT_THAT(intensities, ElementsAre(300.0F, 0.0F, 0.0F, 9.0F));
  how.pick = grid_pick::minimum;
  fill_grid(four, ranges_m, how, intensities);
  EXPECT_EQ(ranges_m[0], 1.0F);
  EXPECT_THAT(intensities, ElementsAre(65'535.0F, 0.0F, 0.0F, 9.0F));
  std::array<float, 4> without{};
  fill_grid(four, without, how);
  EXPECT_EQ(without[0], ranges_m[0]);
  EXPECT_EQ(without[1], ranges_m[1]);
}

TEST(Intensity, OfALaserScanHasTheOrderOfItsRanges) {
  const std::array ranges_m{1.0F, 2.0F, 3.0F, 4.0F};
  const std::array intensities{10.0F, 20.0F, 30.0F, 40.0F};
  std::vector<std::uint8_t> by_angle;
  put_laser_scan(ranges_m, {.intensities = intensities}, by_angle);
  EXPECT_THAT(read_laser_scan(by_angle).ranges, ElementsAre(1.0F, 2.0F, 3.0F, 4.0F));
  EXPECT_THAT(read_laser_scan(by_angle).intensities, ElementsAre(10.0F, 20.0F, 30.0F, 40.0F));
  std::vector<std::uint8_t> by_time;
  put_laser_scan(ranges_m, {.order = scan_order::time, .first_bin = 3, .intensities = intensities},
                 by_time);
  EXPECT_THAT(read_laser_scan(by_time).ranges, ElementsAre(4.0F, 1.0F, 2.0F, 3.0F));
  EXPECT_THAT(read_laser_scan(by_time).intensities, ElementsAre(40.0F, 10.0F, 20.0F, 30.0F));
}

TEST(Intensity, InTheOrderOfTimeIsThatOfThePointWithTheRange) {
  std::array<float, 4> ranges_m{};
  std::array<float, 4> intensities{};
  static_cast<void>(fill_time_grid(four, 40, ranges_m, {}, intensities));
  EXPECT_EQ(ranges_m[0], 2.0F);
  EXPECT_EQ(intensities[0], 300.0F);
  EXPECT_EQ(intensities[1], 0.0F);
}

TEST(Intensity, OfAPointCloud2IsTheLastField) {
  std::vector<std::uint8_t> message;
  put_point_cloud2(four, {.frame_id = "laser", .model = model_named("g2")}, message);
  cdr_reader read(message);
  static_cast<void>(read.number<std::uint64_t>());
  EXPECT_EQ(read.text(), "laser");
  EXPECT_EQ(read.number<std::uint32_t>(), 1U);
  EXPECT_EQ(read.number<std::uint32_t>(), 3U);
  ASSERT_EQ(read.number<std::uint32_t>(), 7U);
  std::uint32_t offset = 0;
  for (const std::string name : {"x", "y", "z", "t", "range", "angle", "intensity"}) {
    EXPECT_EQ(read.text(), name);
    EXPECT_EQ(read.number<std::uint32_t>(), offset);
    EXPECT_EQ(read.number<std::uint8_t>(), name == "t" ? 6 : 7);
    EXPECT_EQ(read.number<std::uint32_t>(), 1U);
    offset += 4;
  }
  EXPECT_EQ(read.number<std::uint8_t>(), 0);
  EXPECT_EQ(read.number<std::uint32_t>(), 28U);
  EXPECT_EQ(read.number<std::uint32_t>(), 84U);
  EXPECT_EQ(read.number<std::uint32_t>(), 84U);
  for (const float intensity : {300.0F, 65'535.0F, 9.0F}) {
    for (int i = 0; i < 6; ++i) static_cast<void>(read.number<std::uint32_t>());
    EXPECT_EQ(read.number<float>(), intensity);
  }
  EXPECT_EQ(read.number<std::uint8_t>(), 1);
  EXPECT_TRUE(read.is_at_end());
}

TEST(Intensity, OfAPcdFileIsTheLastField) {
  const auto cloud = [](pcd_data data, const char* model) {
    return written([&](text_sink& out) {
      write_pcd(std::span(four).first(1), frame::vendor, data, out, *model_named(model));
    });
  };
  const std::string text = cloud(pcd_data::ascii, "g2");
  EXPECT_THAT(text, HasSubstr("\nFIELDS x y z range_m angle_deg time_ns intensity\n"
                              "SIZE 4 4 4 4 4 8 4\nTYPE F F F F F I F\nCOUNT 1 1 1 1 1 1 1\n"
                              "WIDTH 1\n"));
  EXPECT_THAT(text, EndsWith(" 2 1 10 300\n"));
  EXPECT_THAT(cloud(pcd_data::ascii, "g4"), Not(HasSubstr("intensity")));
  EXPECT_THAT(cloud(pcd_data::ascii, "g4"), EndsWith(" 2 1 10\n"));
  // 10 as 64 bits, and 300 as a float.
  EXPECT_THAT(cloud(pcd_data::binary, "g2"),
              EndsWith(std::string("\x0A\0\0\0\0\0\0\0\0\0\x96\x43", 12)));
}

TEST(Intensity, OfAPlyFileIsTheLastProperty) {
  const auto file = [](const char* model) {
    const auto writer =
        make_point_file_writer(point_file_format::ply, frame::vendor, *model_named(model));
    const std::string all = written([&](text_sink& out) {
      writer->begin(out);
      writer->write_points(four, out);
      writer->end(out);
    });
    const std::string begin = writer->first_bytes();
    return begin + all.substr(begin.size());
  };
  const std::string with = file("g2");
  EXPECT_THAT(with, HasSubstr("property uint revolution\nproperty float intensity\nend_header\n"));
  EXPECT_THAT(with, EndsWith(std::string("\0\0\0\0\0\0\x10\x41", 8)));  // revolution 0, and 9
  const std::string without = file("g4");
  EXPECT_THAT(without, Not(HasSubstr("intensity")));
  EXPECT_EQ(with.size() - without.size(), 3 * 4 + std::string("property float intensity\n").size());
}

}  // namespace
}  // namespace g4lidar::test
