// SPDX-License-Identifier: MIT
// g4-ros2 without a network, and with a configuration that cannot be used.
#include <gmock/gmock.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "cli/manager.hpp"
#include "cli/program.hpp"
#include "lidar.hpp"
#include "subscriber.hpp"

namespace ros2 {
namespace {

using ::testing::HasSubstr;

class Domain : public cli::scratch {
 protected:
  test_domain domain_;
};

/// A configuration with this interface.
std::string interface_of(const std::string& attributes) {
  return "<CycloneDDS><Domain><General><Interfaces><NetworkInterface " + attributes +
         "/></Interfaces></General></Domain></CycloneDDS>";
}

TEST_F(Domain, AConfigurationThatIsRefusedIsAUsageError) {
  cli::write_file(path("broken.xml"), "<CycloneDDS><Domain></General></CycloneDDS>");
  const std::vector<std::pair<std::string, std::string>> refused{
      {"<CycloneDDS><Domain><Foo>1</Foo></Domain></CycloneDDS>", "Foo: unknown element"},
      {"<CycloneDDS><Domain><Foo", "Foo"},
      {"file://" + path("broken.xml"), "General"},
      {"file://" + path("missing.xml"), "missing.xml"},
      {interface_of("name=\"nosuch9\""), "nosuch9: does not match an available interface."},
      {interface_of("address=\"203.0.113.9\""), "203.0.113.9: does not match"},
      {interface_of("name=\"lo\"/><NetworkInterface name=\"lo\""), "lo: the same interface"},
      {"<CycloneDDS><Domain><General><ExternalNetworkAddress>a:b</ExternalNetworkAddress></General>"
       "</Domain></CycloneDDS>",
       "a:b"}};
  for (const auto& [value, why] : refused) {
    ::setenv("CYCLONEDDS_URI", value.c_str(), 1);
    cli::program tool({"sim:", "--duration", "60"});
    const cli::outcome end = tool.wait();
    EXPECT_EQ(end.code, 2) << value;
    EXPECT_THAT(end.err, HasSubstr("CYCLONEDDS_URI: ")) << value;
    EXPECT_THAT(end.err, HasSubstr(why)) << value;
    EXPECT_THAT(end.err, HasSubstr("unset it")) << value;
    EXPECT_EQ(std::ranges::count(end.err, '\n'), 1) << end.err;
  }
}

/// The line about the domain, of a simulated lidar.
std::string joined_line(const std::string& source, const std::vector<std::string>& more) {
  std::vector<std::string> words{source, "--duration", "1s", "--namespace", "robot7"};
  words.insert(words.end(), more.begin(), more.end());
  cli::program tool(words);
  const std::string err = tool.wait().err;
  const std::size_t at = std::min(err.find("joined"), err.size());
  return err.substr(at, err.find('\n', at) - at);
}

TEST_F(Domain, TopicsAndReachAreReported) {
  cli::write_file(path("path.txt"), "0 0 0 0\n10 1 0 0\n");
  const std::string moving = "sim:?path=" + path("path.txt");
  const std::string domain = "joined the ROS 2 domain " + std::to_string(test_domain::number());
  EXPECT_EQ(joined_line(moving, {"--points-topic", "off"}),
            domain + " (LOCALHOST): publishing /diagnostics, /robot7/odom, /robot7/scan, /tf");
  EXPECT_EQ(joined_line(moving, {"--tf-topic", "off", "--odometry-topic", "off", "--mount", "0,0,0",
                                 "--tf-static-topic", "off"}),
            domain + " (LOCALHOST): publishing /diagnostics, /robot7/points, /robot7/scan");
  ::setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET", 1);
  EXPECT_EQ(joined_line(moving, {"--interface", "lo", "--odometry-topic", "off", "--mount", "0,0,0",
                                 "--tf-topic", "tf", "--tf-static-topic", "tf_static"}),
            domain +
                " (SUBNET, lo): publishing /diagnostics, /robot7/points, /robot7/scan, "
                "/robot7/tf, /robot7/tf_static");
}

TEST_F(Domain, ALidarThatStandsStillHasNoOdometry) {
  EXPECT_THAT(joined_line("sim:", {}),
              ::testing::EndsWith("publishing /diagnostics, /robot7/points, /robot7/scan"));
}

/// Both together made a domain that Cyclone DDS refuses.
TEST_F(Domain, TheInterfacesOfTheUserWinOverLocalhost) {
  const std::string tag = ::getenv("CYCLONEDDS_URI");
  ::setenv("CYCLONEDDS_URI", (tag + "," + interface_of("name=\"lo\"")).c_str(), 1);
  EXPECT_THAT(joined_line("sim:", {}),
              HasSubstr("(LOCALHOST, the interfaces of CYCLONEDDS_URI): publishing"));
}

TEST_F(Domain, AFileOfConfigThatIsNotToml_IsExplained) {
  const std::vector<std::pair<std::string, std::string>> refused{
      {"grid: 360", "'grid: 360' is YAML; --config reads TOML: grid = 360. See"},
      {"# robot\nloop: true", "'loop: true' is YAML; --config reads TOML: loop = true. See"},
      {"frame-id: laser", "--config reads TOML: frame-id = \"laser\". See"},
      {"fov: \"-60:60\"", "--config reads TOML: fov = \"-60:60\". See"},
      {"g4lidar:\n  ros__parameters:\n    grid: 360",
       "'g4lidar:' is YAML; --config reads TOML. See"},
      {"colour = 3", "unknown option 'colour' in the file of --config"},
      {"[robot]\ngrid = 360", "unknown option 'robot' in the file of --config"}};
  for (const auto& [text, why] : refused) {
    cli::write_file(path("options"), text + "\n");
    const cli::outcome end = cli::program({"sim:", "--config", path("options")}).wait();
    EXPECT_EQ(end.code, 2) << text;
    EXPECT_THAT(end.err, HasSubstr(why)) << text;
  }
}

TEST_F(Domain, AFileOfConfigThatCannotBeRead_IsNoEmptyOne) {
  for (const auto& [file, why] :
       {std::pair{"/proc/self/mem", "--config: the file cannot be read"},
        std::pair{"/dev/zero", "--config: the file is longer than 1 MB"}}) {
    const cli::outcome end = cli::program({"sim:", "-d", "1s", "--config", file}).wait();
    EXPECT_EQ(end.code, 2) << file;
    EXPECT_THAT(end.err, HasSubstr(why));
  }
}

TEST_F(Domain, WordsThatAreAlmostRight_GetASuggestion) {
  cli::write_file(path("options"), "gird = 360\n");
  const std::vector<std::pair<std::vector<std::string>, std::string>> refused{
      {{"sim:", "--gird", "360"}, "--grid"},
      {{"sim:", "--qos", "relaible"}, "reliable"},
      {{"sim:", "--set", "frequncy=7"}, "frequency"},
      {{"sim:", "--config", path("options")}, "grid"}};
  for (const auto& [words, wanted] : refused) {
    const cli::outcome end = cli::program(words).wait();
    EXPECT_EQ(end.code, 2) << wanted;
    EXPECT_THAT(end.err, HasSubstr("; did you mean '" + wanted + "'? See: g4-ros2 --help\n"));
  }
}

TEST_F(Domain, AServiceIsReadyWithoutOne) {
  const cli::manager systemd(path("notify"));
  const served_lidar lidar;
  cli::program tool({lidar.path(), "--interface", "nosuch9"});
  std::vector<std::string> heard;
  EXPECT_TRUE(comes_true([&] {
    const std::vector<std::string> more = systemd.heard();
    heard.insert(heard.end(), more.begin(), more.end());
    return std::ranges::count(heard, "READY=1") == 1 &&
           std::ranges::any_of(heard, [](const std::string& each) {
             return each.find("running") != std::string::npos;
           });
  })) << ::testing::PrintToString(heard);
  tool.send(SIGINT);
  const cli::outcome end = tool.wait();
  EXPECT_EQ(end.code, 130);
  EXPECT_THAT(end.err, HasSubstr("Is the interface nosuch9 there"));
  EXPECT_EQ(end.err.find("nosuch9 there"), end.err.rfind("nosuch9 there")) << end.err;
}

}  // namespace
}  // namespace ros2
