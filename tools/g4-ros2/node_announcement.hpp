// SPDX-License-Identifier: MIT
// The topic that informs ROS 2 about the publishers and subscriptions of each node.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "dds/bus.hpp"
#include "ros2_options.hpp"

namespace g4_tool {

/// The form that a node takes by itself: that of Iron where ROS_DISTRO names such a release; else by the writers of ROS
/// that are in the domain, of which those since Iron state the hashes of their types. *Pure.*
[[nodiscard]] announced_form automatic_form(std::string_view distro, std::size_t with_hash,
                                            std::size_t without_hash);

/// The writers of ROS in a domain. Those of this program and its like are not counted.
class ros_writers {
 public:
  void open(dds_entity_t participant);
  void close() noexcept;
  /// Takes what is new.
  void update();
  /// So many state a hash, or none.
  [[nodiscard]] std::size_t count(bool with_hash) const;
  /// Whether it is an entity of this object.
  [[nodiscard]] bool has(dds_entity_t which) const noexcept {
    return which == participant_reader_.get() || which == reader_.get();
  }

 private:
  using key = std::string;
  struct writer {
    key participant;
    bool has_hash;
  };
  void see(const dds_builtintopic_participant_t& one);
  void see(const dds_builtintopic_endpoint_t& one, bool is_alive);

  dds::entity participant_reader_;
  dds::entity reader_;
  std::map<key, writer> all_;
  std::set<key> like_this_;  // participants
};

/// Publishes the endpoints that were added to the bus before it, each time the domain is created. *Single thread*: that
/// of the bus.
class node_announcement final : public dds::endpoint {
 public:
  /// `node`: "/robot1/g4lidar".
  node_announcement(dds::bus& on, announced_form form, std::string node);

  void open(dds_entity_t participant, int* handle) override;
  void close() noexcept override;
  /// Changes an automatic form if others are in the domain now. Call it about once a second.
  void update();

 private:
  void announce();

  announced_form wanted_;
  announced_form form_ = announced_form::none;  // now
  std::string node_;
  std::string distro_;
  bool was_logged_ = false;
  dds_entity_t participant_ = 0;  // 0: no domain
  ros_writers writers_;
  dds::entity topic_;
  dds::entity writer_;
};

}  // namespace g4_tool
