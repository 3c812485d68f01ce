// SPDX-License-Identifier: MIT
// The network of a domain by the variables of ROS and of Cyclone DDS, without a domain.
#include "dds/network.hpp"

#include <gmock/gmock.h>

#include <map>
#include <string>
#include <vector>

#include "cli/option_rows.hpp"
#include "cli/program.hpp"

namespace ros2 {
namespace {

using g4_tool::bad_value;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
namespace dds = g4_tool::dds;

std::string configured(const std::map<std::string, std::string>& variables,
                       const std::string& interface = "", bool is_connected = false) {
  const auto from = [&variables](const char* name) {
    const auto found = variables.find(name);
    return found == variables.end() ? std::string() : found->second;
  };
  return dds::configuration(dds::read_network({}, interface, from), is_connected);
}

TEST(Network, FollowsTheVariablesOfRos) {
  const auto domain = [](const std::string& value) {
    return dds::read_network({}, "",
                             [&value](const char* name) {
                               return std::string(name) == "ROS_DOMAIN_ID" ? value : std::string();
                             })
        .domain;
  };
  EXPECT_EQ(domain(""), 0U);
  EXPECT_EQ(domain("42"), 42U);
  EXPECT_THROW(domain("233"), bad_value);
  try {
    static_cast<void>(domain("abc"));
    FAIL();
  } catch (const bad_value& reason) {
    EXPECT_STREQ(reason.what(), "ROS_DOMAIN_ID: 'abc' is not in the range 0 to 232");
  }
  EXPECT_EQ(dds::read_network(7, "", [](const char*) { return "42"; }).domain, 7U);

  EXPECT_THAT(configured({}), Not(HasSubstr("AllowMulticast")));
  const std::string local = configured({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"}});
  EXPECT_THAT(local, HasSubstr("<AllowMulticast>false</AllowMulticast>"));
  EXPECT_THAT(local, HasSubstr("<NetworkInterface address=\"127.0.0.1\"/>"));
  EXPECT_THAT(local, HasSubstr("<Peer address=\"localhost\"/>"));
  EXPECT_EQ(configured({{"ROS_LOCALHOST_ONLY", "1"}, {"ROS_STATIC_PEERS", "robot2"}}), local);
  const std::string peers = configured(
      {{"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"}, {"ROS_STATIC_PEERS", "192.0.2.7;robot2"}});
  EXPECT_THAT(peers, HasSubstr("<Peer address=\"192.0.2.7\"/><Peer address=\"robot2\"/>"));
  EXPECT_THAT(configured({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"}}), HasSubstr("<Tag>"));
  EXPECT_EQ(
      configured({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SYSTEM_DEFAULT"}}),
      "<CycloneDDS><Domain><Internal><HeartbeatInterval>10ms</HeartbeatInterval>"
      "<MultipleReceiveThreads>false</MultipleReceiveThreads></Internal></Domain></CycloneDDS>");
  EXPECT_EQ(configured({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "nonsense"}}), local);
  EXPECT_THAT(configured({{"CYCLONEDDS_URI", "file:///x.xml"}}),
              ::testing::EndsWith(",file:///x.xml"));
  EXPECT_THAT(configured({}, "eth0"), HasSubstr("<NetworkInterface name=\"eth0\"/>"));
  EXPECT_THROW(configured({}, "\"/><x"), bad_value);
}

TEST(Network, LocalhostIsLoopbackAndTheFirstNetwork) {
  // What was seen to meet the LOCALHOST of Humble and Jazzy, with both middlewares.
  const std::map<std::string, std::string> local{{"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"}};
  const std::string connected = configured(local, "", true);
  EXPECT_THAT(connected, HasSubstr("<Interfaces><NetworkInterface address=\"127.0.0.1\"/>"
                                   "<NetworkInterface autodetermine=\"true\"/></Interfaces>"));
  EXPECT_THAT(connected, HasSubstr("<AllowMulticast>false</AllowMulticast>"));
  // Multicast on loopback is what Humble with Cyclone DDS listens to, if loopback has multicast.
  const std::string multicast = "<Peer address=\"239.255.0.1\"/>";
  EXPECT_THAT(connected,
              HasSubstr("<Peers><Peer address=\"localhost\"/>" + multicast + "</Peers>"));
  EXPECT_THAT(configured(local), HasSubstr(multicast));
  EXPECT_THAT(configured(local, "eth7", true), Not(HasSubstr(multicast)));
  EXPECT_THAT(configured({}, "", true), Not(HasSubstr(multicast)));
  EXPECT_THAT(connected, HasSubstr("<SPDPInterval>1s</SPDPInterval>"));
  // Without a network it would be loopback twice, which Cyclone DDS refuses.
  EXPECT_THAT(configured(local), Not(HasSubstr("autodetermine")));
  EXPECT_THAT(configured(local, "eth7", true),
              HasSubstr("<Interfaces><NetworkInterface name=\"eth7\"/></Interfaces>"));
  EXPECT_THAT(configured({}, "", true), Not(AnyOf(HasSubstr("Interface"), HasSubstr("SPDP"))));
}

class UserConfiguration : public cli::scratch {
 protected:
  /// With LOCALHOST, before the user's own.
  static std::string before(const std::string& uri) {
    const std::string made = configured(
        {{"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"}, {"CYCLONEDDS_URI", uri}}, "", true);
    EXPECT_TRUE(made.ends_with("," + uri)) << made;
    return made.substr(0, made.size() - uri.size());
  }
};

TEST_F(UserConfiguration, ItsInterfacesAreTheOnlyOnes) {
  const std::string interfaces =
      "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces>"
      "</General></Domain></CycloneDDS>";
  const std::string other =
      "<CycloneDDS><Domain><!-- <Interfaces/> --><Discovery><Tag>x</Tag></Discovery></Domain>"
      "</CycloneDDS>";
  cli::write_file(path("some.xml"), interfaces);
  cli::write_file(path("other.xml"), other);
  const std::string older =
      "<cyclonedds><domain><general><networkinterfaceaddress>lo</networkinterfaceaddress>"
      "</general></domain></cyclonedds>";
  for (const std::string& uri : {interfaces, other + interfaces, other + ", " + interfaces, older,
                                 "file://" + path("some.xml"), path("some.xml"),
                                 "file://" + path("other.xml") + "," + path("some.xml")}) {
    EXPECT_THAT(before(uri), Not(AnyOf(HasSubstr("Interface"), HasSubstr("239.")))) << uri;
    EXPECT_THAT(before(uri), HasSubstr("<AllowMulticast>false")) << uri;
    EXPECT_THAT(configured({{"CYCLONEDDS_URI", uri}}, "eth7"), Not(HasSubstr("eth7"))) << uri;
  }
  for (const std::string& uri : {std::string("<CycloneDDS><Domain><Interf"), other,
                                 path("other.xml"), path("missing.xml")}) {
    EXPECT_THAT(before(uri), HasSubstr("<Interfaces>")) << uri;
  }
}

TEST(Network, MovesOnlyIfAnAddressIsGoneOrAnotherIsFirst) {
  using list = std::vector<std::string>;
  EXPECT_FALSE(dds::has_moved({}, {}));
  EXPECT_TRUE(dds::has_moved({}, {"eth0 192.0.2.2"}));
  EXPECT_FALSE(dds::has_moved({"eth0 192.0.2.2"}, {"eth0 192.0.2.2"}));
  EXPECT_FALSE(dds::has_moved({"eth0 192.0.2.2"}, list{"eth0 192.0.2.2", "docker0 172.17.0.1"}));
  EXPECT_TRUE(
      dds::has_moved({"docker0 172.17.0.1"}, list{"wlan0 192.0.2.2", "docker0 172.17.0.1"}));
  EXPECT_TRUE(dds::has_moved({"eth0 192.0.2.2", "wlan0 192.0.2.7"}, {"eth0 192.0.2.2"}));
  EXPECT_TRUE(dds::has_moved({"eth0 192.0.2.2"}, {"eth0 192.0.2.3"}));
  EXPECT_TRUE(dds::has_moved({"eth0 192.0.2.2"}, {}));
}

}  // namespace
}  // namespace ros2
