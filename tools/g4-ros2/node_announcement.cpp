// SPDX-License-Identifier: MIT
#include "node_announcement.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
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

std::string key_of(const dds_guid_t& guid) { return {std::begin(guid.v), std::end(guid.v)}; }

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
dds_return_t write(dds_entity_t participant, dds_entity_t writer, const ros_writers& hidden,
                   std::string node) {
  using gid = decltype(Message::gid);
  using node_info = std::remove_pointer_t<decltype(Message::node_entities_info_seq._buffer)>;
  const auto gid_of = [](dds_entity_t of) {
    gid made{};
    dds_guid_t guid{};
    static_cast<void>(dds_get_guid(of, &guid));
    std::ranges::copy(guid.v, made.data);
    return made;
  };
  std::vector<gid> readers;
  std::vector<gid> writers;
  for (const dds_entity_t group : children_of(participant)) {
    for (const dds_entity_t each : children_of(group)) {
      if (each == writer || hidden.has(each)) continue;
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

announced_form automatic_form(std::string_view distro, std::size_t with_hash,
                              std::size_t without_hash) {
  constexpr std::array<std::string_view, 5> since_iron{"iron", "jazzy", "kilted", "lyrical",
                                                       "rolling"};
  if (std::ranges::find(since_iron, distro) != since_iron.end()) return announced_form::iron;
  return with_hash == 0 && without_hash > 0 ? announced_form::humble : announced_form::none;
}

void ros_writers::open(dds_entity_t participant) {
  const auto reader_of = [participant](dds_entity_t topic) {
    return dds::entity(dds_create_reader(participant, topic, nullptr, nullptr));
  };
  participant_reader_ = reader_of(DDS_BUILTIN_TOPIC_DCPSPARTICIPANT);
  reader_ = reader_of(DDS_BUILTIN_TOPIC_DCPSPUBLICATION);
}

void ros_writers::close() noexcept {
  participant_reader_ = {};
  reader_ = {};
  all_.clear();
  like_this_.clear();
}

void ros_writers::update() {
  using about = dds_sample_info_t;
  const auto is_alive = [](const about& one) {
    return one.valid_data && one.instance_state == DDS_IST_ALIVE;
  };
  dds::take_all(participant_reader_, [&](const void* sample, const about& one) {
    if (is_alive(one)) see(*static_cast<const dds_builtintopic_participant_t*>(sample));
  });
  dds::take_all(reader_, [&](const void* sample, const about& one) {
    see(*static_cast<const dds_builtintopic_endpoint_t*>(sample), is_alive(one));
  });
}

void ros_writers::see(const dds_builtintopic_participant_t& one) {
  char* name = nullptr;
  if (one.qos != nullptr && dds_qget_entity_name(one.qos, &name) && name != nullptr) {
    if (std::string_view(name) == dds::participant_name) like_this_.insert(key_of(one.key));
  }
  dds_free(name);
}

void ros_writers::see(const dds_builtintopic_endpoint_t& one, bool is_alive) {
  if (!is_alive) {
    all_.erase(key_of(one.key));
    return;
  }
  const std::string_view topic(one.topic_name);
  const bool is_ros = topic.starts_with("rt/") || topic.starts_with("rq/") ||
                      topic.starts_with("rr/") || topic == discovery_topic;
  if (!is_ros) return;
  void* data = nullptr;
  std::size_t size = 0;
  const bool has_data =
      one.qos != nullptr && dds_qget_userdata(one.qos, &data, &size) && data != nullptr;
  const std::string_view words(static_cast<const char*>(data), has_data ? size : 0);
  all_.insert_or_assign(key_of(one.key), writer{key_of(one.participant_key),
                                                words.find("typehash=") != std::string_view::npos});
  dds_free(data);
}

std::size_t ros_writers::count(bool with_hash) const {
  return static_cast<std::size_t>(std::ranges::count_if(all_, [&](const auto& each) {
    return each.second.has_hash == with_hash && !like_this_.contains(each.second.participant);
  }));
}

node_announcement::node_announcement(dds::bus& on, announced_form form, std::string node)
    : endpoint(on), wanted_(form), node_(std::move(node)), distro_(dds::variable("ROS_DISTRO")) {
  on.add(*this);
}

void node_announcement::open(dds_entity_t participant, int* /*handle*/) {
  participant_ = participant;
  if (wanted_ == announced_form::automatic) {
    writers_.open(participant);
    form_ = automatic_form(distro_, 0, 0);
  } else {
    form_ = wanted_;
  }
  announce();
}

void node_announcement::update() {
  if (wanted_ != announced_form::automatic || participant_ == 0) return;
  writers_.update();
  const announced_form now = automatic_form(distro_, writers_.count(true), writers_.count(false));
  if (now == std::exchange(form_, now)) return;
  const bool is_humble = now == announced_form::humble;
  const std::string words =
      is_humble ? "announcing the node to ROS 2 Humble, of which programs are in the domain\n"
                : "not announcing the node any more: see --announce\n";
  // Programs come and go, as each command of ros2 is one.
  std::exchange(was_logged_, true) ? logger::verbose(words) : logger::info(words);
  writer_ = {};
  topic_ = {};
  announce();
}

void node_announcement::announce() {
  if (form_ == announced_form::none) return;
  const bool is_humble = form_ == announced_form::humble;
  const dds::message_type& type = is_humble ? humble_type : iron_type;
  const dds::qos qos = dds::qos_of({.type = &type, .depth = 1, .is_for_late = true});
  topic_ = dds::entity(
      dds_create_topic(participant_, type.descriptor, discovery_topic, nullptr, nullptr));
  writer_ = dds::entity(dds_create_writer(participant_, topic_.get(), qos.get(), nullptr));
  const auto result = is_humble
                          ? write<humble_message>(participant_, writer_.get(), writers_, node_)
                          : write<iron_message>(participant_, writer_.get(), writers_, node_);
  if (result != DDS_RETCODE_OK) logger::info("cannot announce the node\n");
}

void node_announcement::close() noexcept {
  participant_ = 0;
  writers_.close();
  writer_ = {};
  topic_ = {};
}

}  // namespace g4_tool
