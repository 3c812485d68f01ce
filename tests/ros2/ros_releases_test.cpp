// SPDX-License-Identifier: MIT
// What depends on the releases and the middlewares of ROS 2 that are in the domain: the form of the announcement,
// requests of another form, the hashes of types, and the topic that turns the motor with all of them.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "cli/program.hpp"
#include "dds/cdr_message.hpp"
#include "diagnosis.hpp"
#include "lidar.hpp"
#include "node_announcement.hpp"
#include "subscriber.hpp"

namespace ros2 {
namespace {

using g4_tool::announced_form;
using g4_tool::form_for;
using ::testing::HasSubstr;

TEST(FormOfTheAnnouncement, IsThatOfTheRelease) {
  for (const char* const distro : {"iron", "jazzy", "kilted", "lyrical", "rolling"})
    EXPECT_EQ(form_for(distro), announced_form::iron) << distro;
  EXPECT_EQ(form_for("humble"), announced_form::humble);
  for (const char* const distro : {"", "noetic", "foxy"})
    EXPECT_EQ(form_for(distro), announced_form::none) << distro;
}

/// The user data of each topic that was published since this was constructed, also for a moment: samples are taken when
/// they come, before those of the end replace them.
class published {
 public:
  explicit published(const test_domain& in)
      : listener_(dds_create_listener(this), dds_delete_listener) {
    dds_lset_data_available(listener_.get(), [](dds_entity_t reader, void* self) {
      static_cast<published*>(self)->take(reader);
    });
    reader_ = dds::entity(dds_create_reader(in.participant(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION,
                                            nullptr, listener_.get()));
  }
  published(const published&) = delete;
  published& operator=(const published&) = delete;
  std::map<std::string, std::string> data() {
    const std::lock_guard lock(mutex_);
    return data_;
  }

 private:
  void take(dds_entity_t reader) {
    std::array<void*, 64> samples{};
    std::array<dds_sample_info_t, 64> about{};
    const dds_return_t count =
        dds_take(reader, samples.data(), about.data(), samples.size(), samples.size());
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < static_cast<std::size_t>(std::max(count, 0)); ++i) {
      if (!about[i].valid_data) continue;
      const auto& one = *static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
      void* words = nullptr;
      std::size_t size = 0;
      dds_qget_userdata(one.qos, &words, &size);
      data_[one.topic_name].assign(static_cast<const char*>(words), size);
      dds_free(words);
    }
    if (count > 0) static_cast<void>(dds_return_loan(reader, samples.data(), count));
  }

  std::mutex mutex_;
  std::map<std::string, std::string> data_;
  std::unique_ptr<dds_listener_t, void (*)(dds_listener_t*)> listener_;
  dds::entity reader_;  // the last one: its listener uses the others
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

TEST_F(Releases, ADistributionThatIsNamedIsAnnouncedAtOnce) {
  for (const char* const distro : {"jazzy", "humble"}) {
    ::setenv("ROS_DISTRO", distro, 1);
    cli::program tool({"sim:"});
    EXPECT_TRUE(comes_true([&] { return is_announced(); })) << distro;
    tool.send(SIGINT);
    tool.wait();
    EXPECT_TRUE(comes_true([&] { return !is_announced(); })) << distro;
  }
}

TEST_F(Releases, NothingIsAnnouncedWithoutARelease) {
  cli::program tool({"sim:"});
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan);
  ASSERT_TRUE(comes_true([&] { return scans.take() > 0; }));
  EXPECT_FALSE(is_announced());
  tool.send(SIGINT);
}

TEST_F(Releases, EachPublicationHasTheHashOfItsType) {
  published all(domain_);
  cli::write_file(path("path.txt"), "drive forward 1 0.1\n");
  cli::program tool({"sim:?path=" + path("path.txt"), "--mount", "0,0,0", "--announce", "iron"});
  // As rosbags computes them: scripts/ci/ros2.
  const std::map<std::string, std::string> wanted{
      {"rt/scan", "64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828"},
      {"rt/points", "9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"},
      {"rt/tf_static", "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"},
      {"rt/diagnostics", "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"}};
  ASSERT_TRUE(comes_true([&] {
    const auto now = all.data();
    return now.contains("ros_discovery_info") &&
           std::ranges::all_of(wanted, [&](const auto& each) { return now.contains(each.first); });
  }));
  tool.send(SIGINT);
  const auto found = all.data();
  for (const auto& [topic, words] : found) {
    EXPECT_THAT(words, HasSubstr("typehash=RIHS01_")) << topic;
  }
  for (const auto& [topic, hash] : wanted)
    EXPECT_EQ(found.at(topic), "typehash=RIHS01_" + hash + ";");
}

// Another process may not see it, because it ends within milliseconds; this one does.
TEST_F(Releases, APublicationThatLastsAMomentHasTheHashOfItsType) {
  published all(domain_);
  ASSERT_NE(dds::type_in(domain_.participant(), dds::laser_scan), nullptr);
  const auto found = all.data();
  const auto moment = found.find("g4lidar_type_sensor_msgs__msg__dds___LaserScan_");
  ASSERT_NE(moment, found.end());
  EXPECT_THAT(moment->second, HasSubstr("typehash=RIHS01_"));
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
