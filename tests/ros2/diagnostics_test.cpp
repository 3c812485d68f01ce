// SPDX-License-Identifier: MIT
// The status of the topics in /diagnostics.
#include "lidar_diagnostics.hpp"

#include <gmock/gmock.h>

#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "cli/program.hpp"
#include "diagnosis.hpp"
#include "lidar.hpp"
#include "subscriber.hpp"

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
  EXPECT_THAT(first.message, HasSubstr("could not be sent"));
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

/// What was replaced before it was acknowledged may have been received.
TEST(TopicReport, DoesNotWarnOfWhatIsNotAcknowledged) {
  g4_tool::topic_report topics;
  const auto status = topics.status({{"/scan", {.sent = 70, .unacknowledged = 9}}});
  EXPECT_EQ(status.level, g4lidar::diagnostic_level::ok);
  EXPECT_THAT(status.values, Contains(Pair("/scan unacknowledged", "9")));
  EXPECT_THAT(status.values, Contains(Pair("/scan lost", "0")));
}

TEST(Diagnostics, NoTwoLidarsInADomainHaveAStatusOfTheSameName) {
  const test_domain domain;
  subscriber<diagnostic_message> diagnostics(domain, "/diagnostics", dds::diagnostic_array);
  cli::program one({"sim:?serial=2023060700000001", "--namespace", "robot7"});
  cli::program two(
      {"sim:?serial=2023060700000002", "--namespace", "/fleet/robot8", "--node-name", "lidars"});
  cli::program pair({"front=sim:?serial=2023060700000003", "rear=sim:?serial=2023060700000004"});
  std::map<std::string, std::set<std::string>> names;  // of each serial number
  EXPECT_TRUE(comes_true([&] {
    diagnostics.take([&](const diagnostic_message& message) {
      for (std::uint32_t i = 0; i < message.status._length; ++i) {
        const auto& status = message.status._buffer[i];
        names[status.hardware_id].insert(status.name);
      }
    });
    return names.size() - names.count("") == 4;
  }));
  const std::map<std::string, std::string> wanted{{"2023060700000001", "robot7/g4lidar: "},
                                                  {"2023060700000002", "fleet/robot8/lidars: "},
                                                  {"2023060700000003", "g4lidar: front "},
                                                  {"2023060700000004", "g4lidar: rear "}};
  for (const auto& [serial, prefix] : wanted) {
    EXPECT_THAT(names[serial], ::testing::Each(::testing::StartsWith(prefix)));
    EXPECT_THAT(names[serial], Contains(prefix + "state"));
    EXPECT_THAT(names[serial], Contains(prefix + "topics"));
    EXPECT_THAT(names[serial], Contains(prefix + "counts"));
  }
  for (cli::program* const each : {&one, &two, &pair}) each->send(SIGINT);
}

// An X2 and an X3 send the same bytes.
TEST(Diagnostics, StateListsTheModelsThatTheBytesFit) {
  const served_lidar lidar("x2");
  const test_domain domain;
  diagnosis values(domain);
  cli::program tool({lidar.path()});
  EXPECT_TRUE(comes_true([&] { return !values["candidates"].empty(); }));
  EXPECT_THAT(values["candidates"], ::testing::StartsWith("x2, x2l, x3"));
  tool.send(SIGINT);
}

}  // namespace
}  // namespace ros2
