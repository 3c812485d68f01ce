// SPDX-License-Identifier: MIT
// The status of the topics in /diagnostics.
#include "lidar_diagnostics.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "cli/program.hpp"
#include "diagnosis.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "g4lidar/sim/setup.hpp"
#include "g4lidar/sim/world.hpp"
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
  g4lidar::sim::device_options options;
  ASSERT_TRUE(g4lidar::sim::use_model(options, "x2"));
  auto served = g4lidar::sim::background_pty::open(
      g4lidar::sim::device(g4lidar::sim::built_in_world(), options));
  ASSERT_TRUE(served);
  const test_domain domain;
  subscriber<diagnostic_message> diagnostics(domain, "/diagnostics", dds::diagnostic_array);
  cli::program tool({served->path()});
  std::string found;
  EXPECT_TRUE(comes_true([&] {
    diagnostics.take([&](const diagnostic_message& message) {
      for (std::uint32_t i = 0; i < message.status._length; ++i) {
        const auto& status = message.status._buffer[i];
        for (std::uint32_t k = 0; k < status.values._length; ++k) {
          const auto& pair = status.values._buffer[k];
          if (std::string_view(pair.key) == "candidates") found = pair.value;
        }
      }
    });
    return !found.empty();
  }));
  EXPECT_THAT(found, ::testing::StartsWith("x2, x2l, x3"));
  tool.send(SIGINT);
}

TEST(Diagnostics, StateIsAWarningWhereSomethingContradictsTheModel) {
  const test_domain domain;
  diagnosis values(domain);
  cli::program tool({"sim:?model=t-mini-plus&model_id=153"});
  EXPECT_TRUE(comes_true([&] { return !values["contradictions"].empty(); }));
  EXPECT_THAT(values["contradictions"], HasSubstr("153, which no known model has"));
  EXPECT_EQ(values["model"], "t-mini-plus");
  EXPECT_EQ(values["number"], "153");
  EXPECT_EQ(values["g4lidar: state level"], "1");
  EXPECT_THAT(values["g4lidar: state warning"], HasSubstr("153, which no known model has"));
  tool.send(SIGINT);
}

class DiagnosticsOfWorlds : public cli::scratch {};

TEST_F(DiagnosticsOfWorlds, StageOfTheReturnsNamesTheDirectionsWithoutOne) {
  const std::string world = path("world.txt");
  std::ofstream(world) << "wall -900 900 900 900\nlidar 0 0 0\n";  // farther than any lidar sees
  {
    const test_domain domain;
    diagnosis values(domain);
    cli::program tool({"sim:?world=" + world});
    EXPECT_TRUE(comes_true([&] { return values["diagnosis"] == "no_returns"; }));
    EXPECT_EQ(values["g4lidar: returns level"], "1");
    tool.send(SIGINT);
  }
  // 53 degrees of a wall, where the cable leaves the lidar: behind it.
  std::ofstream(world) << "wall 2 -1 2 1\nlidar 0 0 0\n";
  const test_domain domain;
  diagnosis values(domain);
  cli::program tool({"sim:?world=" + world});
  const auto is_near = [&](const char* key, double wanted_deg) {
    const std::string text = values[key];
    return !text.empty() && std::abs(std::remainder(std::stod(text) - wanted_deg, 360.0)) < 4.0;
  };
  // After a few turns.
  EXPECT_TRUE(comes_true([&] {
    return is_near("nothing_from_deg", -153.4) && is_near("nothing_to_deg", 153.4);
  })) << values["nothing_from_deg"]
      << " to " << values["nothing_to_deg"];
  EXPECT_EQ(values["g4lidar: returns level"], "0");
  tool.send(SIGINT);
}

}  // namespace
}  // namespace ros2
