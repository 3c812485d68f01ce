// SPDX-License-Identifier: MIT
// The topic that informs ROS 2 about the publishers and subscriptions of each node.
#pragma once

#include <string>
#include <string_view>

#include "dds/bus.hpp"
#include "ros2_options.hpp"

namespace g4_tool {

/// The form of the release that ROS_DISTRO names; none if it names none. *Pure.*
[[nodiscard]] announced_form form_for(std::string_view distro);

/// Publishes the endpoints that were added to the bus before it, each time the domain is created. *Single thread*: that
/// of the bus.
class node_announcement final : public dds::endpoint {
 public:
  /// `node`: "/robot1/g4lidar".
  node_announcement(dds::bus& bus, announced_form form, std::string node);

  void open(dds_entity_t participant, int* handle) override;
  void close() noexcept override;

 private:
  announced_form form_;
  std::string node_;
  dds::entity topic_;
  dds::entity writer_;
};

}  // namespace g4_tool
