// SPDX-License-Identifier: MIT
// What a recording's LaserScan contains in directions without return.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "made_recording.hpp"
#include "support/laser_scan.hpp"
#include "support/mcap_messages.hpp"

namespace g4lidar::test {
namespace {

/// The ranges of the only LaserScan of a recording.
std::vector<float> recorded_ranges(const recording_options& how, const char* model) {
  const temporary_path path;
  auto writer = made_writer(path.text(), how);
  record_readings(writer, 0, 10);
  const std::array<point, 2> points{
      {{.angle_deg = 0.0F, .range_mm = 1000.0F}, {.angle_deg = 270.0F, .range_mm = 2000.0F}}};
  writer.scan({.points = points, .model = model_named(model)});
  EXPECT_TRUE(writer.close());
  const auto file = bytes_of(path.text());
  const auto messages = mcap_messages(std::string(file.begin(), file.end()), "/scan");
  return read_laser_scan(messages.at(0)).ranges;
}

TEST(ScanRanges, TheModelOfAScan_DecidesTheTurnAndTheNumberOfRanges) {
  const std::vector<float> of_x2 = recorded_ranges({}, "x2");
  ASSERT_EQ(of_x2.size(), 240U);
  EXPECT_EQ(of_x2[120], 1.0F) << "ahead";
  EXPECT_EQ(of_x2[180], 2.0F) << "to the left";
  const std::vector<float> of_g4 = recorded_ranges({}, "g4");
  ASSERT_EQ(of_g4.size(), 720U);
  EXPECT_EQ(of_g4[0], 1.0F) << "behind";
  EXPECT_EQ(of_g4[180], 2.0F) << "to the right";
  EXPECT_EQ(recorded_ranges({}, "tg30").size(), 1600U);
  EXPECT_EQ(recorded_ranges({.scan_bins = 4}, "x2").size(), 4U);
}

/// In the bin of 90 degrees a return at 0.4 m and then none; in that of 180 degrees none.
TEST(ScanRanges, DirectionsWithoutReturn_BecomeWhatTheOptionsSet) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  constexpr float max = 16.0F;
  const auto ranges_of = [](const recording_options& how) {
    const temporary_path path;
    auto writer = made_writer(path.text(), how);
    record_readings(writer, 0, 10);
    for (std::uint32_t revolution = 0; revolution < 2; ++revolution) {
      std::array<point, 3> points{{{.angle_deg = 10.0F, .range_mm = 1000.0F},
                                   {.angle_deg = 90.0F, .range_mm = 400.0F},
                                   {.angle_deg = 180.0F, .flags = point_flags::no_return}}};
      // The same beam, whose direction is 3.1 degrees less without return.
      if (revolution == 1) points[1] = {.angle_deg = 86.9F, .flags = point_flags::no_return};
      for (point& p : points) p.revolution = revolution;
      scan whole;
      whole.points = points;
      writer.scan(whole);
    }
    EXPECT_TRUE(writer.close());
    const auto file = bytes_of(path.text());
    const auto messages = mcap_messages(std::string(file.begin(), file.end()), "/scan");
    EXPECT_EQ(messages.size(), 2U);
    const laser_scan last = read_laser_scan(messages.back());
    EXPECT_EQ(last.frame_id, "laser");
    EXPECT_EQ(last.ranges.size(), 4U);
    std::array<float, 4> ranges{};
    std::ranges::copy(last.ranges, ranges.begin());
    return ranges;
  };
  // From behind, which is 0 degrees of the device, against its sense.
  constexpr std::size_t at_90 = 3;
  constexpr std::size_t at_180 = 2;
  const auto with = [&](const grid_options& grid, std::optional<near_limits> near = {}) {
    return ranges_of({.scan_bins = 4, .grid = grid, .near = near});
  };
  EXPECT_EQ(with({})[at_180], infinity);
  EXPECT_EQ(with({})[at_90], infinity) << "without the flag";
  EXPECT_EQ(with({.no_return = no_return_as::max})[at_90], max);
  EXPECT_TRUE(std::isnan(with({.no_return = no_return_as::nan})[at_180]));
  EXPECT_TRUE(std::isnan(with({}, near_limits{})[at_90]));
  EXPECT_EQ(with({}, near_limits{})[at_180], infinity);
  EXPECT_EQ(with({.near_is_minus_infinity = true}, near_limits{})[at_90], -infinity);
}

}  // namespace
}  // namespace g4lidar::test
