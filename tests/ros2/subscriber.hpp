// SPDX-License-Identifier: MIT
// Readers of Cyclone DDS in the process of the test, in a domain that no other test sees, on loopback.
#pragma once

#include <dds/dds.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string>

#include <messages.h>
#include "dds/bus.hpp"
#include "dds/entity.hpp"
#include "dds/message_type.hpp"
#include "support/patience.hpp"

namespace ros2 {

namespace dds = g4_tool::dds;
using g4lidar::test::comes_true;

using scan_message = sensor_msgs_msg_dds__LaserScan_;
using cloud_message = sensor_msgs_msg_dds__PointCloud2_;
using odometry_message = nav_msgs_msg_dds__Odometry_;
using tf_message = tf2_msgs_msg_dds__TFMessage_;
using diagnostic_message = diagnostic_msgs_msg_dds__DiagnosticArray_;
using clock_message = rosgraph_msgs_msg_dds__Clock_;

/// The variables for programs that this test starts, and for the test itself, and a participant.
class test_domain {
 public:
  /// `instead`: of the configuration that g4-ros2 would have.
  explicit test_domain(const std::string& instead = {}) {
    const std::string tag = std::to_string(identity());
    ::setenv("CYCLONEDDS_URI",
             ("<CycloneDDS><Domain><Discovery><Tag>test_" + tag +
              "</Tag></Discovery></Domain></CycloneDDS>")
                 .c_str(),
             1);
    ::setenv("ROS_DOMAIN_ID", std::to_string(number()).c_str(), 1);
    ::setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST", 1);
    ::unsetenv("ROS_DISTRO");
    const auto wanted = dds::read_network({}, "");
    const std::string how = instead.empty() ? dds::configuration(wanted, !dds::addresses().empty())
                                            : instead + "," + wanted.more;
    domain_ = dds::entity(dds_create_domain(number(), how.c_str()));
    if (dds::is_on_loopback(wanted)) dds::keep_multicast_here();
    participant_ = dds::entity(dds_create_participant(number(), nullptr, nullptr));
    EXPECT_TRUE(participant_);
  }
  /// No other test that runs has it: that of this process, or of the test that has started it. Participants
  /// with another tag are not seen, also where they have the number of the domain.
  [[nodiscard]] static std::uint32_t identity() {
    const char* const given = std::getenv("G4_ROS2_TEST_IDENTITY");
    return static_cast<std::uint32_t>(given != nullptr ? std::atoi(given) : ::getpid());
  }
  /// Of the domain. The ports of higher domains may be in use: the system gives them to any program.
  [[nodiscard]] static std::uint32_t number() { return identity() % 100U + 1U; }
  [[nodiscard]] dds_entity_t participant() const noexcept { return participant_.get(); }

 private:
  dds::entity domain_;
  dds::entity participant_;
};

struct reading {
  bool is_reliable = true;
  int depth = 10;
  bool is_for_late = false;
};

template <class Message>
class subscriber {
 public:
  subscriber(const test_domain& in, const std::string& name, const dds::message_type& type,
             const reading& how = {}) {
    const dds::qos quality = dds::qos_of({.name = name,
                                          .type = &type,
                                          .is_reliable = how.is_reliable,
                                          .depth = how.depth,
                                          .is_for_late = how.is_for_late});
    topic_ = dds::entity(dds_create_topic(in.participant(), type.descriptor, ("rt" + name).c_str(),
                                          nullptr, nullptr));
    reader_ =
        dds::entity(dds_create_reader(in.participant(), topic_.get(), quality.get(), nullptr));
    EXPECT_TRUE(reader_) << name;
  }

  /// Calls `use` with each message that is there; how many there were.
  template <class Use>
  std::size_t take(Use use) {
    std::array<void*, 32> samples{};
    std::array<dds_sample_info_t, 32> about{};
    std::size_t taken = 0;
    while (true) {
      const dds_return_t count =
          dds_take(reader_.get(), samples.data(), about.data(), samples.size(), samples.size());
      if (count <= 0) return taken;
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        if (!about[i].valid_data) continue;
        use(*static_cast<const Message*>(samples[i]));
        ++taken;
      }
      static_cast<void>(dds_return_loan(reader_.get(), samples.data(), count));
    }
  }
  std::size_t take() {
    return take([](const Message&) {});
  }

  /// How many publishers there are.
  [[nodiscard]] std::uint32_t publishers() const {
    dds_subscription_matched_status_t matched{};
    static_cast<void>(dds_get_subscription_matched_status(reader_.get(), &matched));
    return matched.current_count;
  }
  [[nodiscard]] dds_entity_t handle() const noexcept { return reader_.get(); }

 private:
  dds::entity topic_;
  dds::entity reader_;
};

/// A writer with the quality of service of ROS 2.
template <class Message>
class publisher {
 public:
  publisher(const test_domain& in, const std::string& name, const dds::message_type& type)
      : topic_(dds_create_topic(in.participant(), type.descriptor, ("rt" + name).c_str(), nullptr,
                                nullptr)) {
    const dds::qos quality = dds::qos_of({.name = name, .type = &type});
    writer_ =
        dds::entity(dds_create_writer(in.participant(), topic_.get(), quality.get(), nullptr));
    EXPECT_TRUE(writer_) << name;
  }
  void write(const Message& what) const {
    EXPECT_EQ(dds_write(writer_.get(), &what), DDS_RETCODE_OK);
  }
  [[nodiscard]] std::uint32_t subscribers() const {
    dds_publication_matched_status_t matched{};
    static_cast<void>(dds_get_publication_matched_status(writer_.get(), &matched));
    return matched.current_count;
  }

 private:
  dds::entity topic_;
  dds::entity writer_;
};

}  // namespace ros2
