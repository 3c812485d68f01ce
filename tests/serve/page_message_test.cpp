// SPDX-License-Identifier: MIT
// The binary message of a revolution to pages, by docs/serve.md.
#include <gtest/gtest.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "page_protocol.hpp"

namespace {

using namespace g4_tool;

template <class Number>
Number number_at(const std::vector<std::uint8_t>& data, std::size_t at) {
  Number value;
  std::memcpy(&value, &data.at(at), sizeof(value));  // this processor is little-endian
  return value;
}

TEST(PageScan, HasTheReturnsInTheRobotsFrame) {
  if constexpr (std::endian::native != std::endian::little) GTEST_SKIP();
  using g4lidar::point;
  const std::vector<point> points{
      {.angle_deg = 180.0F, .range_mm = 2000.0F},  // opposite the cable: ahead
      {.angle_deg = 0.0F, .range_mm = 0.0F, .flags = g4lidar::point_flags::no_return},
      {.angle_deg = 90.0F, .range_mm = 500.0F}};  // clockwise from the cable: left
  std::vector<std::uint8_t> data{7};
  put_page_scan({.revolution = {.points = points, .revolution = 42}, .stamp_s = 1.5}, data);
  data.erase(data.begin());
  ASSERT_EQ(data.size(), 16U + 2 * 8);
  EXPECT_EQ(data[0], 0x10);
  EXPECT_EQ(data[1], 1);
  EXPECT_EQ(number_at<std::uint16_t>(data, 2), 2);
  EXPECT_EQ(number_at<std::uint32_t>(data, 4), 42U);
  EXPECT_EQ(number_at<double>(data, 8), 1.5);
  EXPECT_NEAR(number_at<float>(data, 16), 2.0F, 1e-5F);
  EXPECT_NEAR(number_at<float>(data, 20), 0.0F, 1e-5F);
  EXPECT_NEAR(number_at<float>(data, 24), 0.0F, 1e-5F);
  EXPECT_NEAR(number_at<float>(data, 28), 0.5F, 1e-5F);
}

TEST(PageScan, OfARevolutionThatIsNotWhole_IsMarked) {
  const std::vector<g4lidar::point> points{{.angle_deg = 180.0F, .range_mm = 2000.0F}};
  std::vector<std::uint8_t> data;
  put_page_scan(
      {.revolution = {.points = points, .flags = g4lidar::scan_flags::data_lost}, .stamp_s = 1.5},
      data);
  EXPECT_EQ(data.at(1), 0);
}

TEST(PageScan, HasThePlace_AfterTheReturns) {
  if constexpr (std::endian::native != std::endian::little) GTEST_SKIP();
  using g4lidar::point;
  const std::vector<point> points{
      {.angle_deg = 90.0F, .range_mm = 500.0F},
      {.angle_deg = 0.0F, .range_mm = 0.0F, .flags = g4lidar::point_flags::no_return},
      {.angle_deg = 180.0F, .range_mm = 2000.0F}};
  std::vector<std::uint8_t> data;
  put_page_scan({.revolution = {.points = points},
                 .stamp_s = 1.5,
                 .place = lidar_place{{1.0, -2.0, 0.5}, 7},
                 .is_upside_down = true},
                data);
  ASSERT_EQ(data.size(), 16U + 2 * 8 + 28);
  EXPECT_EQ(data[1], 1 + 2);
  EXPECT_NEAR(number_at<float>(data, 20), -0.5F, 1e-5F);  // seen from above it is at the other side
  EXPECT_EQ(number_at<std::uint32_t>(data, 32), 7U);
  EXPECT_EQ(number_at<double>(data, 36), 1.0);
  EXPECT_EQ(number_at<double>(data, 44), -2.0);
  EXPECT_EQ(number_at<double>(data, 52), 0.5);
}

TEST(PageScan, OfSeveralLidars_SaysWhichPointIsOfWhich) {
  if constexpr (std::endian::native != std::endian::little) GTEST_SKIP();
  using g4lidar::point;
  const point none{.angle_deg = 0.0F, .flags = g4lidar::point_flags::no_return};
  const std::vector<point> points{{.angle_deg = 180.0F, .range_mm = 1000.0F},
                                  none,
                                  {.angle_deg = 90.0F, .range_mm = 500.0F},
                                  none,
                                  {.angle_deg = 180.0F, .range_mm = 2000.0F}};
  const std::vector<std::size_t> points_of_each{3, 0, 2};  // the second one has no fresh scan
  std::vector<std::uint8_t> data;
  put_page_scan({.revolution = {.points = points},
                 .stamp_s = 1.5,
                 .place = lidar_place{{1.0, -2.0, 0.5}, 7},
                 .points_of_each = points_of_each},
                data);
  ASSERT_EQ(data.size(), 16U + 3 * 8 + 28 + 2 + 3 * 2);
  EXPECT_EQ(data[1], 1 + 2 + 4);
  EXPECT_EQ(number_at<std::uint16_t>(data, 2), 3);
  const std::size_t lidars = 16 + 3 * 8 + 28;
  EXPECT_EQ(number_at<std::uint16_t>(data, lidars), 3);
  EXPECT_EQ(number_at<std::uint16_t>(data, lidars + 2), 2);  // without the one that did not return
  EXPECT_EQ(number_at<std::uint16_t>(data, lidars + 4), 0);
  EXPECT_EQ(number_at<std::uint16_t>(data, lidars + 6), 1);
}

TEST(PageScan, OfManyReturns_CountsThoseThatItHas) {
  if constexpr (std::endian::native != std::endian::little) GTEST_SKIP();
  const std::vector<g4lidar::point> points(70'000, {.angle_deg = 180.0F, .range_mm = 1000.0F});
  const std::vector<std::size_t> points_of_each{60'000, 10'000};
  std::vector<std::uint8_t> data;
  put_page_scan(
      {.revolution = {.points = points}, .stamp_s = 1.5, .points_of_each = points_of_each}, data);
  EXPECT_EQ(number_at<std::uint16_t>(data, 2), 65'535);
  EXPECT_EQ(number_at<std::uint16_t>(data, 16 + 65'535 * 8 + 2), 60'000);
  EXPECT_EQ(number_at<std::uint16_t>(data, 16 + 65'535 * 8 + 4), 5'535);
}

TEST(PageScan, HasTheIntensitiesOfAModelThatMeasuresThem_AtItsEnd) {
  if constexpr (std::endian::native != std::endian::little) GTEST_SKIP();
  using g4lidar::point;
  const std::vector<point> points{
      {.angle_deg = 90.0F, .range_mm = 500.0F, .intensity = 258},
      {.angle_deg = 0.0F, .flags = g4lidar::point_flags::no_return, .intensity = 3},
      {.angle_deg = 180.0F, .range_mm = 2000.0F, .intensity = 7}};
  std::vector<std::uint8_t> data;
  put_page_scan(
      {.revolution = {.points = points, .model = g4lidar::model_named("t-mini")}, .stamp_s = 1.5},
      data);
  ASSERT_EQ(data.size(), 16U + 2 * 8 + 2 * 2);
  EXPECT_EQ(data[1], 1 + 8);
  EXPECT_EQ(number_at<std::uint16_t>(data, 32), 258);
  EXPECT_EQ(number_at<std::uint16_t>(data, 34), 7);
}

}  // namespace
