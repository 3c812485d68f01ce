// SPDX-License-Identifier: MIT
// Names and the arguments of ROS 2, without a domain.
#include "options.hpp"

#include <gmock/gmock.h>

#include <map>
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
using g4_tool::without_ros_arguments;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

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
  for (const std::string& words : {longest + "=sim:", "-r:__ns:=/" + longest,
                                   "-r:__node:=" + longest, "-r:scan:=" + longest}) {
    std::vector<std::string> all{words};
    if (words.starts_with("-r:")) all = {"sim:", "--ros-args", "-r", words.substr(3)};
    const cli::outcome refused = cli::run(all);
    EXPECT_EQ(refused.code, 2) << words.substr(0, 20) << refused.signal;
    EXPECT_LT(refused.err.size(), 1000U) << words.substr(0, 20);
  }
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

std::vector<std::string> translated(const std::vector<std::string>& words) {
  const auto options = std::make_shared<ros2_options>();
  return without_ros_arguments(words, ros2_rows(options));
}

TEST(RosArguments, BecomeOptions) {
  EXPECT_THAT(translated({"sim:", "--grid", "90"}), ElementsAre("sim:", "--grid", "90"));
  EXPECT_THAT(translated({"sim:", "--ros-args", "-r", "__ns:=/robot1", "--remap", "scan:=front",
                          "-r", "__node:=lidar", "--", "-v"}),
              ElementsAre("sim:", "--namespace", "/robot1", "--scan-topic", "front", "--node-name",
                          "lidar", "-v"));
  EXPECT_THAT(translated({"--ros-args", "-p", "frame_id:=front_laser", "-p", "standby:=true", "-p",
                          "merge:=false", "--log-level", "info", "-p", "use_sim_time:=true"}),
              ElementsAre("--frame-id", "front_laser", "--standby"));
  EXPECT_THAT(translated({"--ros-args", "-p", "speckle:=near=100,count=2", "-p", "edges:=true"}),
              ElementsAre("--edges", "--speckle=near=100,count=2"));
  EXPECT_THROW(translated({"--ros-args", "-p", "nonsense:=1"}), bad_value);
  EXPECT_THROW(translated({"--ros-args", "-r", "nonsense"}), bad_value);
  EXPECT_THROW(translated({"--ros-args", "-p", "grid"}), bad_value);
  EXPECT_THROW(translated({"--ros-args", "-p", "standby:=sometimes"}), bad_value);
  EXPECT_THROW(translated({"--ros-args", "-p", "grid:=[1, 2]"}), bad_value);
}

TEST(RosArguments, HaveTheBooleansOfYamlAndTheLastValueCounts) {
  for (const char* const yes : {"true", "True", "TRUE", "yes", "on"}) {
    EXPECT_THAT(translated({"--ros-args", "-p", std::string("standby:=") + yes}),
                ElementsAre("--standby"))
        << yes;
  }
  for (const char* const no : {"false", "False", "no", "Off"}) {
    EXPECT_THAT(
        translated({"--ros-args", "-p", "standby:=true", "-p", std::string("standby:=") + no}),
        ElementsAre())
        << no;
  }
  EXPECT_THAT(translated({"--ros-args", "-p", "grid:=90", "-p", "fov:=-90:90", "-p", "grid:=180"}),
              ElementsAre("--fov", "-90:90", "--grid", "180"));
}

TEST(RosArguments, RenameTopicsByTheirFullNames) {
  EXPECT_THAT(translated({"--ros-args", "-r", "/scan:=/front"}),
              ElementsAre("--scan-topic", "/front"));
  EXPECT_THAT(translated({"--ros-args", "-r", "/robot1/points:=cloud", "-r", "__ns:=/robot1"}),
              ElementsAre("--points-topic", "cloud", "--namespace", "/robot1"));
  EXPECT_THAT(translated({"--ros-args", "-r", "~/points:=cloud"}),
              ElementsAre("--points-topic", "cloud"));
  EXPECT_THAT(translated({"--ros-args", "-r", "/tf:=tf", "-r", "/tf_static:=tf_static"}),
              ElementsAre("--tf-topic", "tf", "--tf-static-topic", "tf_static"));
  EXPECT_THAT(translated({"--ros-args", "-r", "~/run:=/lidars"}),
              ElementsAre("--run-topic", "/lidars"));
  EXPECT_THAT(translated({"--ros-args", "-r", "tf:=/x"}), ElementsAre("--tf-topic", "/x"));
  EXPECT_THAT(translated({"--ros-args", "-r", "scan:=~/scan", "-r", "__ns:=/robot1"}),
              ElementsAre("--scan-topic", "/robot1/g4lidar/scan", "--namespace", "/robot1"));
}

TEST(RosArguments, OfOtherNodesAreIgnoredWithAWarning) {
  ::testing::internal::CaptureStderr();
  EXPECT_THAT(translated({"--ros-args", "-r", "/scan:=/front", "-r", "__ns:=/robot1", "-e", "/x",
                          "--remap", "nonsense:=1", "--enclave", "/y", "-p", "grid:=90"}),
              ElementsAre("--namespace", "/robot1", "--grid", "90"));
  const std::string warnings = ::testing::internal::GetCapturedStderr();
  for (const char* const each : {"'/scan:=/front'", "'-e /x'", "'nonsense:=1'", "'--enclave /y'"}) {
    EXPECT_THAT(warnings, HasSubstr(std::string(each) + " is ignored"));
  }
}

class ParameterFile : public cli::scratch {
 protected:
  std::vector<std::string> read(const std::string& text,
                                const std::vector<std::string>& more = {}) {
    cli::write_file(path("robot.yaml"), text);
    std::vector<std::string> all{"--ros-args", "--params-file", path("robot.yaml")};
    all.insert(all.end(), more.begin(), more.end());
    return translated(all);
  }
};

TEST_F(ParameterFile, IsReadForThisNode) {
  const std::string all =
      "/**:\n  ros__parameters:\n    frame_id: laser2\n    use_sim_time: true\n    standby: True\n";
  EXPECT_THAT(read(all), ElementsAre("--frame-id", "laser2", "--standby"));
  EXPECT_THAT(read(all, {"-p", "frame_id:=laser3", "-p", "standby:=false"}),
              ElementsAre("--frame-id", "laser3"));
  const std::string some =
      "other:\n  ros__parameters:\n    nonsense: 1\n"
      "g4lidar:\n  ros__parameters:\n    grid: 90\n    set: [frequency=10, sample_rate=8000]\n"
      "robot1:\n  front:\n    ros__parameters: {grid: 180}\n";
  EXPECT_THAT(read(some),
              ElementsAre("--grid", "90", "--set", "frequency=10", "--set", "sample_rate=8000"));
  EXPECT_THAT(read(some, {"-r", "__ns:=/robot1", "-r", "__node:=front"}),
              ElementsAre("--namespace", "/robot1", "--node-name", "front", "--grid", "180"));
}

TEST_F(ParameterFile, ThatCannotBeUsedIsNamed) {
  EXPECT_THAT(refusal_of([] { translated({"--ros-args", "--params-file", "/nosuch.yaml"}); }),
              HasSubstr("cannot read '/nosuch.yaml'"));
  for (const char* const text : {"/**:\n  ros__parameters: {nonsense: 1}\n", "/**: 5\n",
                                 "/**:\n  ros__parameters: {grid: {a: 1}}\n", "a: [\n", "- 1\n",
                                 "/**:\n  ros__parameters: {set: [[1]]}\n"}) {
    EXPECT_NE(refusal_of([&] { read(text); }), "") << text;
  }
  EXPECT_THAT(refusal_of([] { translated({"--ros-args", "--params-file", "/"}); }),
              HasSubstr("cannot read '/'"));
  EXPECT_THAT(refusal_of([&] { read("/**:\n  ros__parameters: [1]\n"); }),
              HasSubstr("needs names"));
  EXPECT_THAT(read(""), ElementsAre());
  EXPECT_THAT(read("/**:\n  ros__parameters:\n"), ElementsAre());
}

TEST_F(ParameterFile, ForOtherNodesOnlyIsRefused) {
  const std::string of_another = "ydlidar_ros2_driver_node:\n  ros__parameters: {port: /dev/x}\n";
  EXPECT_THAT(refusal_of([&] { read(of_another); }),
              AllOf(HasSubstr("for the node /g4lidar, but for /ydlidar_ros2_driver_node"),
                    HasSubstr("docs/migrating.md"), Not(HasSubstr("\n"))));
  const std::string of_this = "g4lidar:\n  ros__parameters: {grid: 90}\n";
  EXPECT_NE(refusal_of([&] { read(of_this, {"-r", "__ns:=/robot1"}); }), "");
  EXPECT_THAT(read(of_another + of_this), ElementsAre("--grid", "90"));
}

TEST_F(ParameterFile, ThatContainsItselfIsRefused) {
  EXPECT_THAT(refusal_of([&] { read("a: &a\n  b: *a\n"); }), HasSubstr("too many sections"));
  std::string text = "a0: &a0 {x: {ros__parameters: {}}}\n";
  for (int i = 1; i < 30; ++i) {
    const std::string below = "*a" + std::to_string(i - 1);
    const std::string name = "a" + std::to_string(i);
    text.append(name + ": &" + name + " {p: " + below + ", q: " + below + "}\n");
  }
  EXPECT_THAT(refusal_of([&] { read(text); }), HasSubstr("too many sections"));
}

}  // namespace
}  // namespace ros2
