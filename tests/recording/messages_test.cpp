// SPDX-License-Identifier: MIT
// Single messages of a recording: valid ones are read as written, invalid ones are refused.
#include "recording/mcap/messages.hpp"
#include "recording/mcap/metadata.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string_view>
#include <vector>

#include "g4lidar/message/ros_messages.hpp"

namespace g4lidar::test {
namespace {

bytes message_of(const recorded_event& event, mcap::record_text& memory) {
  mcap::put_event(memory, event, 0);
  return memory.all();
}

TEST(Messages, Event_IsReadAsWritten) {
  mcap::record_text memory;
  const auto read = mcap::event_from(message_of({.what = recorded_event::kind::begun,
                                                 .delivers = true,
                                                 .baud = 230400,
                                                 .sample_rate_hz = 8000,
                                                 .unparsed = 7,
                                                 .events = 3,
                                                 .time_ns = 123'456'789},
                                                memory));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->what, recorded_event::kind::begun);
  EXPECT_EQ(read->sample_rate_hz, 8000U);
  EXPECT_EQ(read->unparsed, 7U);
  EXPECT_EQ(read->events, 3U);
  EXPECT_EQ(read->time_ns, 123'456'789);
}

TEST(Messages, ExtremeSampleRate_IsRefused) {
  for (const std::uint32_t rate : {0U, 1'000'001U, UINT32_MAX}) {
    mcap::record_text memory;
    const recorded_event event{.what = recorded_event::kind::begun, .sample_rate_hz = rate};
    EXPECT_FALSE(mcap::event_from(message_of(event, memory))) << rate;
  }
  mcap::record_text memory;  // a stream that has not begun has no rate
  EXPECT_TRUE(mcap::event_from(message_of({.what = recorded_event::kind::held}, memory)));
}

TEST(Messages, TruncatedEvent_IsRefused) {
  mcap::record_text memory;
  const bytes whole = message_of(
      {.what = recorded_event::kind::opened, .name = "/dev/ttyUSB0", .zero = zero_angle{-7375}},
      memory);
  EXPECT_EQ(mcap::event_from(whole)->zero, zero_angle{-7375});
  // Older recordings end behind the name, whose text ends with a zero.
  const auto name_end = std::ranges::search(whole, std::string_view("ttyUSB0\0", 8)).end();
  const auto older = static_cast<std::size_t>(name_end - whole.begin());
  const std::size_t counted = whole.size() - 1;  // the flag of counted times is the last one
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto read = mcap::event_from(whole.first(size));
    EXPECT_EQ(read.has_value(), size == older || size == counted) << size;
    if (read) {
      EXPECT_EQ(read->zero.has_value(), size == counted);
      EXPECT_FALSE(read->counts_times);
    }
  }
}

std::vector<std::uint8_t> odometry_bytes(const odometry_message& what) {
  std::vector<std::uint8_t> message;
  put_odometry(what, message);
  return message;
}

TEST(Messages, Odometry_IsReadAsWritten) {
  for (const std::string_view frame : {"", "o", "odom", "a/long/name"}) {
    for (const double yaw : {0.0, 1.0, -3.0, 3.1415, 1e-9}) {
      const auto message = odometry_bytes({.stamp_ns = -1'500'000'000,
                                           .frame_id = frame,
                                           .pose = {1.5, -2.0, yaw},
                                           .twist = {0.5, 0.25, -0.125}});
      const auto read = mcap::odometry_from(message);
      ASSERT_TRUE(read);
      EXPECT_EQ(read->time_ns, -1'500'000'000);
      EXPECT_EQ(read->pose.x_m, 1.5);
      EXPECT_EQ(read->pose.y_m, -2.0);
      EXPECT_NEAR(read->pose.yaw_rad, yaw, 1e-15);
      EXPECT_EQ(read->twist, (twist_2d{0.5, 0.25, -0.125}));
    }
  }
}

TEST(Messages, OtherOdometry_IsRefused) {
  const auto whole = odometry_bytes({.pose = {1.0, 2.0, 3.0}});
  ASSERT_TRUE(mcap::odometry_from(whole));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(mcap::odometry_from(bytes(whole).first(size))) << size;
  }
  auto longer = whole;
  longer.push_back(0);
  EXPECT_FALSE(mcap::odometry_from(longer));
  auto big_endian = whole;
  big_endian[1] = 0;
  EXPECT_FALSE(mcap::odometry_from(big_endian));
  const double bad = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(mcap::odometry_from(odometry_bytes({.pose = {1.0, bad, 0.0}})));
  EXPECT_FALSE(mcap::odometry_from(odometry_bytes({.twist = {1.0, 0.0, bad}})));
}

}  // namespace
}  // namespace g4lidar::test
