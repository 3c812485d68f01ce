// SPDX-License-Identifier: MIT
// What depends on the releases and the middlewares of ROS 2 that are in the domain: the form of the announcement,
// requests of another form, the hashes of types, and the topic that turns the motor with all of them.
#include <gmock/gmock.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <map>
#include <string>

#include "cli/program.hpp"
#include "diagnosis.hpp"
#include "lidar.hpp"
#include "node_announcement.hpp"
#include "subscriber.hpp"

namespace ros2 {
namespace {

using g4_tool::announced_form;
using g4_tool::automatic_form;
using ::testing::HasSubstr;

TEST(AutomaticForm, IsThatOfTheReleaseOrOfTheDomain) {
  for (const char* const distro : {"iron", "jazzy", "kilted", "lyrical", "rolling"}) {
    EXPECT_EQ(automatic_form(distro, 0, 0), announced_form::iron) << distro;
    EXPECT_EQ(automatic_form(distro, 0, 9), announced_form::iron) << distro;
  }
  for (const char* const distro : {"", "humble", "noetic"}) {
    EXPECT_EQ(automatic_form(distro, 0, 0), announced_form::none) << distro;
    EXPECT_EQ(automatic_form(distro, 0, 9), announced_form::humble) << distro;
    // Never guessed: a Humble node that comes later would get it.
    EXPECT_EQ(automatic_form(distro, 9, 0), announced_form::none) << distro;
    EXPECT_EQ(automatic_form(distro, 1, 9), announced_form::none) << distro;
  }
}

/// The user data of each topic that was published since this was constructed, also for a moment.
class published {
 public:
  explicit published(const test_domain& in)
      : reader_(dds_create_reader(in.participant(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr,
                                  nullptr)) {}
  std::map<std::string, std::string> data() {
    std::array<void*, 64> samples{};
    std::array<dds_sample_info_t, 64> about{};
    const dds_return_t count =
        dds_take(reader_.get(), samples.data(), about.data(), samples.size(), samples.size());
    for (std::size_t i = 0; i < static_cast<std::size_t>(std::max(count, 0)); ++i) {
      if (!about[i].valid_data) continue;
      const auto& one = *static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
      void* words = nullptr;
      std::size_t size = 0;
      dds_qget_userdata(one.qos, &words, &size);
      data_[one.topic_name].assign(static_cast<const char*>(words), size);
      dds_free(words);
    }
    if (count > 0) static_cast<void>(dds_return_loan(reader_.get(), samples.data(), count));
    return data_;
  }

 private:
  dds::entity reader_;
  std::map<std::string, std::string> data_;
};

/// A writer of ROS: since Iron with the hash of its type.
class ros_writer {
 public:
  ros_writer(const test_domain& in, const std::string& name, const std::string& user_data)
      : topic_(dds_create_topic(in.participant(), dds::bool_message.descriptor, name.c_str(),
                                nullptr, nullptr)) {
    const dds::qos quality = dds::qos_of({.type = &dds::bool_message});
    dds_qset_userdata(quality.get(), user_data.data(), user_data.size());
    writer_ =
        dds::entity(dds_create_writer(in.participant(), topic_.get(), quality.get(), nullptr));
    EXPECT_TRUE(writer_);
  }

 private:
  dds::entity topic_;
  dds::entity writer_;
};

class Releases : public cli::scratch {
 protected:
  /// Whether the publication of the announcement is there now.
  [[nodiscard]] bool is_announced() const {
    const dds::entity reader(dds_create_reader(
        domain_.participant(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr));
    std::array<void*, 128> samples{};
    std::array<dds_sample_info_t, 128> about{};
    bool is_there = false;
    const dds_return_t count =
        dds_take(reader.get(), samples.data(), about.data(), samples.size(), samples.size());
    for (std::size_t i = 0; i < static_cast<std::size_t>(std::max(count, 0)); ++i) {
      if (!about[i].valid_data || about[i].instance_state != DDS_IST_ALIVE) continue;
      const auto& one = *static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
      is_there = is_there || std::string(one.topic_name) == "ros_discovery_info";
    }
    if (count > 0) static_cast<void>(dds_return_loan(reader.get(), samples.data(), count));
    return is_there;
  }
  test_domain domain_;
};

TEST_F(Releases, HumbleAloneGetsItsAnnouncementUntilAnotherReleaseComes) {
  const served_lidar lidar;
  const served_lidar another;
  // Another program like this one, whose writers have hashes, does not count as Iron.
  cli::program like({another.path(), "--namespace", "other", "--announce", "none"});
  subscriber<scan_message> others(domain_, "/other/scan", dds::laser_scan);
  ASSERT_TRUE(comes_true([&] { return others.take() > 0; }));
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan);
  cli::program tool({lidar.path()});
  ASSERT_TRUE(comes_true([&] { return scans.take() > 0; }));
  EXPECT_FALSE(is_announced());
  {
    const ros_writer humble(domain_, "rt/rosout", "");
    EXPECT_TRUE(comes_true([&] { return is_announced(); }));
    const ros_writer jazzy(domain_, "rt/parameter_events", "typehash=RIHS01_0;");
    EXPECT_TRUE(comes_true([&] { return !is_announced(); }));
  }
  const ros_writer other(domain_, "topic_of_another_program", "");
  const ros_writer humble(domain_, "rr/node/get_parametersReply", "serviceid=1;");
  EXPECT_TRUE(comes_true([&] { return is_announced(); }));
  for (cli::program* const each : {&like, &tool}) each->send(SIGINT);
  EXPECT_THAT(tool.wait().err, HasSubstr("announcing the node to ROS 2 Humble"));
}

TEST_F(Releases, ADistributionThatIsNamedIsAnnouncedAtOnce) {
  ::setenv("ROS_DISTRO", "jazzy", 1);
  cli::program tool({"sim:"});
  EXPECT_TRUE(comes_true([&] { return is_announced(); }));
  tool.send(SIGINT);
}

TEST_F(Releases, EachPublicationHasTheHashOfItsType) {
  published all(domain_);
  cli::write_file(path("path.txt"), "drive forward 1 0.1\n");
  cli::program tool({"sim:?path=" + path("path.txt"), "--mount", "0,0,0", "--announce", "iron"});
  ASSERT_TRUE(comes_true([&] {
    const auto& now = all.data();
    return now.contains("ros_discovery_info") && now.contains("rt/scan") &&
           now.contains("g4lidar_type_sensor_msgs__msg__dds___LaserScan_");
  }));
  auto found = all.data();
  tool.send(SIGINT);
  for (const auto& [topic, words] : found) {
    EXPECT_THAT(words, HasSubstr("typehash=RIHS01_")) << topic;
  }
  EXPECT_EQ(found["g4lidar_type_sensor_msgs__msg__dds___LaserScan_"], found["rt/scan"]);
}

TEST_F(Releases, ATopicRestsAndTurnsTheMotor) {
  const served_lidar lidar;
  for (const std::string name : {"/robot1/lidars/run", "/run_it"}) {
    cli::program tool(
        {lidar.path(), "--namespace", "robot1", "--node-name", "lidars", "--run-topic", name});
    const publisher<std_msgs_msg_dds__Bool_> run(domain_, name, dds::bool_message);
    ASSERT_TRUE(comes_true([&] { return lidar.motor_turns() && run.subscribers() == 1; }));
    run.write({false});
    EXPECT_TRUE(comes_true([&] { return !lidar.motor_turns(); }));
    run.write({true});
    EXPECT_TRUE(comes_true([&] { return lidar.motor_turns(); }));
    tool.send(SIGINT);
    EXPECT_EQ(tool.wait().code, 130);
  }
}

TEST_F(Releases, TheTopicOfTheMotorIsBelowTheNodeOrOff) {
  const publisher<std_msgs_msg_dds__Bool_> run(domain_, "/robot1/lidars/run", dds::bool_message);
  cli::program tool({"sim:", "--namespace", "robot1", "--node-name", "lidars"});
  EXPECT_TRUE(comes_true([&] { return run.subscribers() == 1; }));
  tool.send(SIGINT);
  EXPECT_TRUE(comes_true([&] { return run.subscribers() == 0; }));
  diagnosis diagnostics(domain_);
  cli::program without(
      {"sim:", "--namespace", "robot1", "--node-name", "lidars", "--run-topic", "off"});
  EXPECT_TRUE(comes_true([&] { return diagnostics["robot1/lidars: state level"] == "0"; }));
  EXPECT_EQ(run.subscribers(), 0U);
  without.send(SIGINT);
}

}  // namespace
}  // namespace ros2
