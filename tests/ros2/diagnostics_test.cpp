// SPDX-License-Identifier: MIT
// What /diagnostics says of the topics.
#include "lidar_diagnostics.hpp"

#include <gmock/gmock.h>

#include <cstdint>

namespace ros2 {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Pair;

TEST(TopicReport, WarnsOfWhatIsNewAndKeepsTheTotals) {
  g4_tool::topic_report topics;
  const auto status = [&topics](std::uint64_t lost, std::uint32_t refused) {
    return topics.status({{"/scan", {.sent = 70, .lost = lost, .refused = refused}},
                          {"/points", {.sent = 60, .lost = 2, .subscribers = 1}}});
  };
  const auto first = status(0, 0);
  EXPECT_EQ(first.level, g4lidar::diagnostic_level::warn);
  EXPECT_THAT(first.message, HasSubstr("too slow"));
  const auto same = status(0, 0);
  EXPECT_EQ(same.level, g4lidar::diagnostic_level::ok);
  EXPECT_EQ(same.message, "ok");
  EXPECT_THAT(same.values, Contains(Pair("/points lost", "2")));
  EXPECT_THAT(same.values, Contains(Pair("/scan sent", "70")));
  EXPECT_EQ(status(1, 0).level, g4lidar::diagnostic_level::warn);
  EXPECT_EQ(status(1, 0).level, g4lidar::diagnostic_level::ok);
  const auto refused = status(1, 1);
  EXPECT_EQ(refused.level, g4lidar::diagnostic_level::warn);
  EXPECT_THAT(refused.message, HasSubstr("--qos"));
  EXPECT_EQ(status(1, 1).level, g4lidar::diagnostic_level::ok);
  EXPECT_THAT(status(1, 1).values, Contains(Pair("/scan refused", "1")));
  EXPECT_EQ(status(1, 0).level, g4lidar::diagnostic_level::ok);  // another network
  EXPECT_EQ(status(1, 1).level, g4lidar::diagnostic_level::warn);
}

}  // namespace
}  // namespace ros2
