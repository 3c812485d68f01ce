// SPDX-License-Identifier: MIT
// A LaserScan, read from its message.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "support/cdr_reader.hpp"

namespace g4lidar::test {

/// The members of sensor_msgs/LaserScan, and of the header of it.
struct laser_scan {
  std::int32_t seconds = 0;
  std::uint32_t nanoseconds = 0;
  std::string frame_id;
  float angle_min = 0.0F;
  float angle_max = 0.0F;
  float increment = 0.0F;
  float time_increment = 0.0F;
  float scan_time = 0.0F;
  float range_min = 0.0F;
  float range_max = 0.0F;
  std::vector<float> ranges;
  std::vector<float> intensities;
};

inline laser_scan read_laser_scan(const std::vector<std::uint8_t>& message) {
  cdr_reader read(message);
  laser_scan made;
  made.seconds = read.number<std::int32_t>();
  made.nanoseconds = read.number<std::uint32_t>();
  made.frame_id = read.text();
  for (float* each : {&made.angle_min, &made.angle_max, &made.increment, &made.time_increment,
                      &made.scan_time, &made.range_min, &made.range_max}) {
    *each = read.number<float>();
  }
  for (auto* const values : {&made.ranges, &made.intensities}) {
    values->resize(read.number<std::uint32_t>());
    for (float& value : *values) value = read.number<float>();
  }
  EXPECT_TRUE(read.is_at_end());
  return made;
}

}  // namespace g4lidar::test
