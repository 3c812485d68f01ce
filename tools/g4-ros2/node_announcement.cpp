// SPDX-License-Identifier: MIT
#include "node_announcement.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

#include <messages.h>
#include "cli/logger.hpp"

namespace g4_tool {
namespace {

using humble_message = rmw_dds_common_humble_msg_dds__ParticipantEntitiesInfo_;
using iron_message = rmw_dds_common_msg_dds__ParticipantEntitiesInfo_;

const dds::message_type iron_type{
    &rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc,
    "e725f4a506958c79f95dd693b965722c57b19cd18e7eff984f49561b93dc985d"};

dds_topic_descriptor_t humble_descriptor() {
  dds_topic_descriptor_t made = rmw_dds_common_humble_msg_dds__ParticipantEntitiesInfo__desc;
  made.m_typename = iron_type.descriptor->m_typename;
  return made;
}

const dds_topic_descriptor_t humble_described = humble_descriptor();
const dds::message_type humble_type{
    &humble_described, "2b40df2d2f4d5cd690221a503f406fe3673efcc4151a9f049b4d3569ecf5c4e4"};

constexpr const char* discovery_topic = "ros_discovery_info";

std::vector<dds_entity_t> children_of(dds_entity_t parent) {
  std::vector<dds_entity_t> all(64);
  while (true) {
    const dds_return_t count = dds_get_children(parent, all.data(), all.size());
    const auto known = static_cast<std::size_t>(std::max(count, 0));
    const bool is_all = known <= all.size();
    all.resize(known);
    if (is_all) return all;
  }
}

/// `parts` become the contents of a sequence, which does not own them.
template <class Sequence, class Part>
void refer(Sequence& sequence, std::vector<Part>& parts) {
  sequence._length = sequence._maximum = static_cast<std::uint32_t>(parts.size());
  sequence._buffer = parts.data();
}

template <class Message>
dds_return_t write(dds_entity_t participant, dds_entity_t writer, std::string node) {
  using gid = decltype(Message::gid);
  using node_info = std::remove_pointer_t<decltype(Message::node_entities_info_seq._buffer)>;
  const auto gid_of = [](dds_entity_t entity) {
    gid made{};
    dds_guid_t guid{};
    static_cast<void>(dds_get_guid(entity, &guid));
    std::ranges::copy(guid.v, made.data);
    return made;
  };
  std::vector<gid> readers;
  std::vector<gid> writers;
  for (const dds_entity_t group : children_of(participant)) {
    for (const dds_entity_t each : children_of(group)) {
      if (each == writer) continue;
      (dds_get_publisher(each) > 0 ? writers : readers).push_back(gid_of(each));
    }
  }
  const std::size_t slash = node.rfind('/');
  std::string name = node.substr(slash + 1);
  node.resize(std::max<std::size_t>(slash, 1));
  std::vector<node_info> nodes(1);
  nodes.front().node_namespace = node.data();
  nodes.front().node_name = name.data();
  refer(nodes.front().reader_gid_seq, readers);
  refer(nodes.front().writer_gid_seq, writers);
  Message message{};
  message.gid = gid_of(participant);
  refer(message.node_entities_info_seq, nodes);
  return dds_write(writer, &message);
}

}  // namespace

announced_form form_for(std::string_view distro) {
  constexpr std::array<std::string_view, 5> since_iron{"iron", "jazzy", "kilted", "lyrical",
                                                       "rolling"};
  if (std::ranges::find(since_iron, distro) != since_iron.end()) return announced_form::iron;
  return distro == "humble" ? announced_form::humble : announced_form::none;
}

node_announcement::node_announcement(dds::bus& bus, announced_form form, std::string node)
    : endpoint(bus),
      form_(form == announced_form::automatic ? form_for(dds::variable("ROS_DISTRO")) : form),
      node_(std::move(node)) {
  bus.add(*this);
}

void node_announcement::open(dds_entity_t participant, int* /*handle*/) {
  if (form_ == announced_form::none) return;
  const bool is_humble = form_ == announced_form::humble;
  const dds::message_type& type = is_humble ? humble_type : iron_type;
  const dds::qos qos = dds::qos_of({.type = &type, .depth = 1, .is_for_late = true});
  topic_ = dds::entity(
      dds_create_topic(participant, type.descriptor, discovery_topic, nullptr, nullptr));
  writer_ = dds::entity(dds_create_writer(participant, topic_.get(), qos.get(), nullptr));
  const auto result = is_humble ? write<humble_message>(participant, writer_.get(), node_)
                                : write<iron_message>(participant, writer_.get(), node_);
  if (result != DDS_RETCODE_OK) logger::info("cannot announce the node\n");
}

void node_announcement::close() noexcept {
  writer_ = {};
  topic_ = {};
}

}  // namespace g4_tool
