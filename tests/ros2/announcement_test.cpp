// SPDX-License-Identifier: MIT
// The node in ros_discovery_info, against what DDS reports of the same participant.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <utility>

#include "cli/program.hpp"
#include "lidar.hpp"
#include "node_announcement.hpp"
#include "subscriber.hpp"

namespace ros2 {
namespace {

using humble_message = rmw_dds_common_humble_msg_dds__ParticipantEntitiesInfo_;
using iron_message = rmw_dds_common_msg_dds__ParticipantEntitiesInfo_;
using keys = std::set<std::string>;

std::string key_of(std::span<const std::uint8_t> bytes) { return {bytes.begin(), bytes.end()}; }

/// A participant: its key, and those of its endpoints.
struct members {
  std::string participant;
  keys readers;
  keys writers;
  bool operator==(const members&) const = default;
};

struct announced {
  std::string node;
  members has;
};

class Announcement : public cli::scratch {
 protected:
  /// What DDS reports of the participant that is not this test's.
  members found() {
    members made;
    builtin(DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, [&](const void* sample) {
      const auto& one = *static_cast<const dds_builtintopic_participant_t*>(sample);
      if (is_own(one.key)) return;
      made.participant = key_of(one.key.v);
      void* data = nullptr;
      std::size_t size = 0;
      if (dds_qget_userdata(one.qos, &data, &size)) {
        user_data_.assign(static_cast<const char*>(data), size);
      }
      dds_free(data);
    });
    for (auto [topic, into] : {std::pair{DDS_BUILTIN_TOPIC_DCPSPUBLICATION, &made.writers},
                               std::pair{DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, &made.readers}}) {
      builtin(topic, [&](const void* sample) {
        const auto& one = *static_cast<const dds_builtintopic_endpoint_t*>(sample);
        const bool is_ours = std::string(one.topic_name) == "ros_discovery_info";
        if (!is_own(one.participant_key) && !is_ours) into->insert(key_of(one.key.v));
      });
    }
    return made;
  }

  /// As it comes to somebody who subscribes now.
  template <class Message>
  announced heard(const dds_topic_descriptor_t& described) {
    const dds::entity topic(dds_create_topic(domain_.participant(), &described,
                                             "ros_discovery_info", nullptr, nullptr));
    const dds::message_type type{&described, ""};
    const dds::qos quality = dds::qos_of({.type = &type, .depth = 1, .is_for_late = true});
    const dds::entity reader(
        dds_create_reader(domain_.participant(), topic.get(), quality.get(), nullptr));
    announced made;
    void* sample = nullptr;
    dds_sample_info_t about{};
    EXPECT_TRUE(comes_true([&] {
      if (dds_take(reader.get(), &sample, &about, 1, 1) <= 0) return false;
      if (about.valid_data) made = read(*static_cast<const Message*>(sample));
      static_cast<void>(dds_return_loan(reader.get(), &sample, 1));
      return !made.node.empty();
    }));
    return made;
  }

  test_domain domain_;
  std::string user_data_;

 private:
  template <class Message>
  static announced read(const Message& message) {
    announced made;
    EXPECT_EQ(message.node_entities_info_seq._length, 1U);
    if (message.node_entities_info_seq._length == 0) return made;
    const auto& node = message.node_entities_info_seq._buffer[0];
    made.node = std::string(node.node_namespace) + " " + node.node_name;
    made.has.participant = gid_key(message.gid);
    for (const auto& [gids, into] : {std::pair{&node.reader_gid_seq, &made.has.readers},
                                     std::pair{&node.writer_gid_seq, &made.has.writers}}) {
      for (std::uint32_t i = 0; i < gids->_length; ++i) into->insert(gid_key(gids->_buffer[i]));
    }
    return made;
  }
  /// The 16 bytes of DDS; further ones are 0.
  template <class Gid>
  static std::string gid_key(const Gid& gid) {
    const std::span<const std::uint8_t> all(gid.data);
    EXPECT_TRUE(std::ranges::all_of(all.subspan(16), [](std::uint8_t byte) { return byte == 0; }));
    return key_of(all.first(16));
  }
  [[nodiscard]] bool is_own(const dds_guid_t& guid) const {
    dds_guid_t own{};
    static_cast<void>(dds_get_guid(domain_.participant(), &own));
    return std::ranges::equal(own.v, guid.v);
  }
  template <class Use>
  void builtin(dds_entity_t topic, Use use) {
    const dds::entity reader(dds_create_reader(domain_.participant(), topic, nullptr, nullptr));
    std::array<void*, 128> samples{};
    std::array<dds_sample_info_t, 128> about{};
    const dds_return_t count =
        dds_take(reader.get(), samples.data(), about.data(), samples.size(), samples.size());
    for (std::size_t i = 0; i < static_cast<std::size_t>(std::max(count, 0)); ++i) {
      const bool is_alive = about[i].instance_state == DDS_IST_ALIVE;
      if (about[i].valid_data && is_alive) use(samples[i]);
    }
    if (count > 0) static_cast<void>(dds_return_loan(reader.get(), samples.data(), count));
  }
};

dds_topic_descriptor_t humble_described() {
  dds_topic_descriptor_t made = rmw_dds_common_humble_msg_dds__ParticipantEntitiesInfo__desc;
  made.m_typename = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";
  return made;
}

TEST_F(Announcement, OfAllThatTheNodeHasInBothForms) {
  const served_lidar front;
  const served_lidar rear;
  for (const std::string form : {"humble", "iron"}) {
    cli::program tool({"front=" + front.path(), "rear=" + rear.path(), "--namespace", "robot1",
                       "--node-name", "lidars", "--announce", form});
    const announced node =
        form == "iron" ? heard<iron_message>(rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc)
                       : heard<humble_message>(humble_described());
    EXPECT_EQ(node.node, "/robot1 lidars");
    EXPECT_GE(node.has.writers.size(), 6U);  // of two lidars: scan, points, diagnostics
    EXPECT_EQ(node.has.readers.size(), 1U);  // run
    EXPECT_TRUE(comes_true([&] { return found() == node.has; }));
    EXPECT_EQ(user_data_, "enclave=/;");
    tool.send(SIGINT);
    EXPECT_EQ(tool.wait().code, 130);
    EXPECT_TRUE(comes_true([&] { return found() == members{}; }));
  }
}

TEST_F(Announcement, StaysWhenALidarGoesAndComes) {
  const served_lidar lidar;
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan);
  cli::program tool({lidar.path(), "--announce", "iron"});
  ASSERT_TRUE(comes_true([&] { return scans.take() > 0; }));
  const auto& type = rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc;
  const announced before = heard<iron_message>(type);
  EXPECT_EQ(before.node, "/ g4lidar");
  lidar.unplug(true);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  static_cast<void>(scans.take());
  lidar.unplug(false);
  EXPECT_TRUE(comes_true([&] { return scans.take() > 0; }));
  EXPECT_EQ(heard<iron_message>(type).has, before.has);
  EXPECT_TRUE(comes_true([&] { return found() == before.has; }));
  tool.send(SIGINT);
}

TEST_F(Announcement, IsMadeAgainInEachNewDomain) {
  // A second domain of this process, with the number of the first one on the network.
  dds::network wanted = dds::read_network(210, "");
  wanted.more += ",<CycloneDDS><Domain><Discovery><ExternalDomainId>" +
                 std::to_string(test_domain::number()) +
                 "</ExternalDomainId></Discovery></Domain></CycloneDDS>";
  dds::bus bus(wanted);
  const dds::publisher scans(bus, {.name = "/scan", .type = &dds::laser_scan});
  const g4_tool::node_announcement node(bus, g4_tool::announced_form::iron, "/g4lidar");
  const auto& type = rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc;
  bus.update();
  const announced first = heard<iron_message>(type);
  EXPECT_EQ(first.has.writers.size(), 1U);
  EXPECT_TRUE(comes_true([&] { return found() == first.has; }));
  bus.close();
  EXPECT_TRUE(comes_true([&] { return found() == members{}; }));
  bus.update();
  const announced second = heard<iron_message>(type);
  EXPECT_NE(second.has.participant, first.has.participant);
  EXPECT_TRUE(comes_true([&] { return found() == second.has; }));
}

}  // namespace
}  // namespace ros2
