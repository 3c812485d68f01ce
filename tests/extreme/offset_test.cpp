// SPDX-License-Identifier: MIT
// Offsets of zero, times of clouds and values of parameters, with extreme numbers.
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "g4lidar/core/model.hpp"
#include "g4lidar/core/reply_watch.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/options/lidar_parameters.hpp"
#include "g4lidar/recording/raw_bytes.hpp"
#include "numbers.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::extreme;

TEST(ExtremeOffset, OfZero) {
  for (const std::int32_t cdeg : values<std::int32_t>()) {
    for (const float angle_deg : values<float>()) {
      zero_offset offset;
      offset.set({cdeg}, zero_offset::stated_by::user);
      std::array<point, 1> points{{{.angle_deg = angle_deg}}};
      offset.add_to(points);
    }
  }
}

TEST(ExtremeOffset, TimesOfACloud) {
  for (const std::int64_t first_ns : values<std::int64_t>()) {
    for (const std::int64_t second_ns : values<std::int64_t>()) {
      const std::array<point, 2> points{{{.range_mm = 1000.0F, .time_ns = first_ns},
                                         {.range_mm = 1000.0F, .time_ns = second_ns}}};
      const std::int64_t made_ns = cloud_time_ns(points);
      EXPECT_TRUE(made_ns == first_ns || made_ns == second_ns);
    }
  }
}

TEST(ExtremeOffset, ValuesOfEachType) {
  for (unsigned type = 0; type < 5; ++type) {
    const auto wanted = static_cast<std::uint8_t>(type);
    for (const double number : values<double>()) {
      EXPECT_LT(converted(parameter_value(number), wanted).index(), 5U);
    }
    for (const std::int64_t number : values<std::int64_t>()) {
      EXPECT_LT(converted(parameter_value(number), wanted).index(), 5U);
    }
  }
}

TEST(ExtremeOffset, CopiesOfBytes) {
  for (const bool is_wanted : {false, true}) {
    raw_copy copy(g4_model);
    std::vector<std::uint8_t> out;
    for (const std::uint8_t byte : values<std::uint8_t>()) {
      const std::vector<std::uint8_t> data(300, byte);
      copy.received(data, is_wanted, out);
    }
    EXPECT_EQ(out.empty(), !is_wanted);
  }
}

}  // namespace
