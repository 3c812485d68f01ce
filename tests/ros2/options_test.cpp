// SPDX-License-Identifier: MIT
// Names of ROS 2, without a domain.
#include "ros2_options.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/program.hpp"

namespace ros2 {
namespace {

using g4_tool::bad_value;
using g4_tool::full_name;
using g4_tool::named_source;
using g4_tool::ros2_options;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Names, AreInTheNamespaceUnlessTheyBeginWithASlash) {
  EXPECT_EQ(full_name("", "scan"), "/scan");
  EXPECT_EQ(full_name("robot1", "scan"), "/robot1/scan");
  EXPECT_EQ(full_name("/robot1/", "front/scan"), "/robot1/front/scan");
  EXPECT_EQ(full_name("/robot1", "/tf"), "/tf");
  EXPECT_EQ(full_name("/", ""), "");
  for (const char* const wrong : {"1scan", "a b", "a//b", "a-b", "a/", "a__b", "__a"}) {
    EXPECT_THROW(static_cast<void>(full_name("", wrong)), bad_value) << wrong;
  }
}

/// A topic has at most 247 characters, with its namespace.
TEST(Names, LongerThanRos2Allows_AreRefused) {
  EXPECT_EQ(full_name("", std::string(246, 'a')).size(), 247U);
  EXPECT_THROW(static_cast<void>(full_name("", std::string(247, 'a'))), bad_value);
  EXPECT_THROW(static_cast<void>(full_name(std::string(240, 'n'), "points")), bad_value);
  const std::string longest(66'000, 'a');
  for (const char* const option :
       {"--namespace", "--node-name", "--scan-topic", "--points-topic", "--diagnostics-topic",
        "--odometry-topic", "--tf-topic", "--tf-static-topic", "--frame-id", "--base-frame",
        "--odometry-frame"}) {
    const cli::outcome refused = cli::run({option, longest, "sim:"});
    EXPECT_EQ(refused.code, 2) << option << refused.signal;
    EXPECT_THAT(refused.err, HasSubstr("at most 247 characters")) << option;
    EXPECT_LT(refused.err.size(), 1000U) << option;
  }
  const cli::outcome refused = cli::run({longest + "=sim:"});
  EXPECT_EQ(refused.code, 2) << refused.signal;
  EXPECT_LT(refused.err.size(), 1000U);
}

std::vector<std::string> names_of(std::vector<std::string> sources, const char* mounted = nullptr) {
  ros2_options options;
  options.sources = std::move(sources);
  if (mounted != nullptr) options.mounts.emplace_back(mounted, g4lidar::mounting{});
  std::vector<std::string> names;
  for (const named_source& each : g4_tool::sources_of(options)) {
    names.push_back(each.name + "=" + each.source);
  }
  return names;
}

TEST(Sources, HaveNamesIfThereAreSeveral) {
  EXPECT_THAT(names_of({}), ElementsAre("="));
  EXPECT_THAT(names_of({"sim:?seed=5"}), ElementsAre("=sim:?seed=5"));
  EXPECT_THAT(names_of({"front=/dev/ttyUSB0", "rear=serial:2021"}, "rear"),
              ElementsAre("front=/dev/ttyUSB0", "rear=serial:2021"));
  EXPECT_THROW(names_of({"a", "b"}), bad_value);
  EXPECT_THROW(names_of({"x=a", "b"}), bad_value);
  EXPECT_THROW(names_of({"x=a", "x=b"}), bad_value);
  EXPECT_THROW(names_of({"x=a"}, "y"), bad_value);
}

template <class Function>
std::string refusal_of(Function function) {
  try {
    function();
  } catch (const bad_value& reason) {
    return reason.what();
  }
  return "";
}

TEST(Sources, RefusalsNameTheLidarsThatThereAre) {
  const auto refusal = [](const std::vector<std::string>& sources) {
    return refusal_of([&] { names_of(sources, "side"); });
  };
  EXPECT_THAT(refusal({"front=a", "rear=b"}), HasSubstr("'side'; there is 'front', 'rear'"));
  EXPECT_THAT(refusal({"sim:"}), HasSubstr("one without a name"));
}

TEST(Frames, HaveTheNameOfTheLidarAfterTheLastSlash) {
  ros2_options options;
  EXPECT_EQ(g4_tool::frame_of(options, ""), "laser");
  EXPECT_EQ(g4_tool::frame_of(options, "front"), "front_laser");
  options.frames.lidar = "robot7/laser";
  EXPECT_EQ(g4_tool::frame_of(options, ""), "robot7/laser");
  EXPECT_EQ(g4_tool::frame_of(options, "front"), "robot7/front_laser");
}

TEST(Topics, HaveOneTypeEach) {
  const auto refusal = [](const char* scan, const char* points, const char* name_space) {
    ros2_options options;
    options.sources = {"front=a", "rear=b"};
    options.topics.scan = scan;
    options.topics.points = points;
    options.name_space = name_space;
    return refusal_of([&] { static_cast<void>(g4_tool::sources_of(options)); });
  };
  EXPECT_EQ(refusal("off", "off", ""), "");
  EXPECT_EQ(refusal("/all", "points", "x"), "");
  EXPECT_EQ(refusal("all", "all", "x"),
            "--points-topic: /x/front/all is the topic of --scan-topic");
  EXPECT_THAT(refusal("all", "/x/rear/all", "x"), HasSubstr("/x/rear/all"));
  EXPECT_THAT(refusal("scan", "/diagnostics", ""), HasSubstr("/diagnostics"));
  EXPECT_THAT(refusal("/tf", "points", ""), HasSubstr("/tf"));
  ros2_options options;
  options.topics.tf = options.topics.tf_static = "off";
  options.topics.scan = "/tf";
  options.topics.points = "/tf_static";
  EXPECT_EQ(g4_tool::sources_of(options).size(), 1U);
  options.topics.scan = "scan";
  options.topics.points = "points";
  options.topics.tf = "tf";
  options.topics.tf_static = "/robot1/tf";
  EXPECT_EQ(g4_tool::sources_of(options).size(), 1U);
  options.name_space = "robot1";
  EXPECT_EQ(refusal_of([&] { static_cast<void>(g4_tool::sources_of(options)); }),
            "--tf-static-topic: /robot1/tf is the topic of --tf-topic");
  options.topics.tf_static = "tf_static";
  options.topics.run = "tf";
  EXPECT_EQ(refusal_of([&] { static_cast<void>(g4_tool::sources_of(options)); }),
            "--run-topic: /robot1/tf is the topic of --tf-topic");
}

TEST(Topics, HaveNames) {
  int seen = 0;
  for (const auto& row : ros2_rows(std::make_shared<ros2_options>())) {
    if (!row.names.ends_with("-topic")) continue;
    EXPECT_THROW(row.take(""), bad_value) << row.names;
    ++seen;
  }
  EXPECT_EQ(seen, 7);
}

TEST(Sources, FilesAreNotMerged) {
  ros2_options options;
  options.sources = {"front=sim:", "rear=file:/tmp/walk.bin"};
  EXPECT_EQ(g4_tool::sources_of(options).size(), 2U);
  options.merges = true;
  EXPECT_THROW(static_cast<void>(g4_tool::sources_of(options)), bad_value);
  options.sources[1] = "rear=sim:";
  EXPECT_EQ(g4_tool::sources_of(options).size(), 2U);
}

TEST(RosArguments, AreRefusedInALineThatNamesTheOptionsAndThePackage) {
  for (const std::vector<std::string>& words : {std::vector<std::string>{"-r", "__ns:=/robot1"},
                                                {"-p", "grid:=360"},
                                                {"--params-file", "robot.yaml"},
                                                {}}) {
    std::vector<std::string> all{"sim:", "--ros-args"};
    all.insert(all.end(), words.begin(), words.end());
    const cli::outcome refused = cli::run(all);
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.err,
                AllOf(HasSubstr("--namespace"), HasSubstr("--node-name"), HasSubstr("--scan-topic"),
                      HasSubstr("--config"), HasSubstr("source is SOURCE"), HasSubstr("is --set"),
                      HasSubstr("g4lidar_ros"), HasSubstr("g4-ros2 --help\n")));
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1);
  }
}

}  // namespace
}  // namespace ros2
