// SPDX-License-Identifier: MIT
// What every part of the C interface uses: names of results, the version, the clock.
#include <array>
#include <cstdint>
#include <ctime>
#include <string>

#include "c_handles.hpp"

namespace {

TEST(CBase, EveryResultHasItsName) {
  EXPECT_STREQ(g4lidar_result_name(G4LIDAR_OK), "ok");
  EXPECT_STREQ(g4lidar_result_name(G4LIDAR_BAD_ARGUMENT), "bad_argument");
  EXPECT_STREQ(g4lidar_result_name(G4LIDAR_NO_MEMORY), "no_memory");
  EXPECT_STREQ(g4lidar_result_name(G4LIDAR_NOTHING), "nothing");
  EXPECT_STREQ(g4lidar_result_name(G4LIDAR_INTERNAL), "internal");
  constexpr std::array names{
      "bad_option",   "no_port",       "several_ports",  "permission",   "busy",
      "not_serial",   "bad_baud_rate", "cannot_connect", "silence",      "garbage",
      "other_device", "does_not_stop", "unhealthy",      "timeout",      "wrong_answer",
      "not_reached",  "bad_setting",   "scanning",       "not_scanning", "reconnecting",
      "gone",         "stalled",       "brown_out",      "interference", "read_only",
      "bad_file",     "end_of_input",  "cancelled",      "system",       "not_supported"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_STREQ(g4lidar_result_name(static_cast<int>(i) + 1), names[i]);
  }
  EXPECT_STREQ(g4lidar_result_name(31), "unknown");
  EXPECT_STREQ(g4lidar_result_name(-5), "unknown");
  EXPECT_STREQ(g4lidar_event_name(0), "unknown");
  EXPECT_STREQ(g4lidar_event_name(G4LIDAR_EVENT_OVERFLOW), "overflow");
  EXPECT_STREQ(g4lidar_event_name(G4LIDAR_EVENT_STILL_TURNING), "still_turning");
  EXPECT_STREQ(g4lidar_event_name(G4LIDAR_EVENT_NO_ZERO_ANGLE), "no_zero_angle");
  EXPECT_STREQ(g4lidar_event_name(G4LIDAR_EVENT_OTHER_NUMBER), "other_number");
  EXPECT_STREQ(g4lidar_event_name(15), "unknown");
}

TEST(CBase, TheVersionIsThatOfTheHeader) {
  const std::string wanted = std::to_string(G4LIDAR_VERSION_MAJOR) + "." +
                             std::to_string(G4LIDAR_VERSION_MINOR) + "." +
                             std::to_string(G4LIDAR_VERSION_PATCH);
  EXPECT_EQ(g4lidar_version(), wanted);
  EXPECT_EQ(g4lidar_version_number(),
            10000 * G4LIDAR_VERSION_MAJOR + 100 * G4LIDAR_VERSION_MINOR + G4LIDAR_VERSION_PATCH);
  EXPECT_TRUE(g4lidar_has_feature("simulator"));
  EXPECT_FALSE(g4lidar_has_feature("nonsense"));
}

std::int64_t monotonic_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

TEST(CBase, NowIsTheMonotonicClock) {
  const std::int64_t before = monotonic_ns();
  const std::int64_t now = g4lidar_now_ns();
  EXPECT_LE(before, now);
  EXPECT_LE(now, monotonic_ns());
}

}  // namespace
