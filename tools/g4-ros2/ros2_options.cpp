// SPDX-License-Identifier: MIT
#include "ros2_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "cli/logger.hpp"
#include "cli/option_rows.hpp"

namespace g4_tool {
namespace {

/// The longest name of ROS 2: that of a topic, with its namespace.
constexpr std::size_t longest_name = 247;

void check_length(std::string_view name) {
  if (name.size() <= longest_name) return;
  throw bad_value(fmt::format("a name of ROS 2 has at most {} characters; '{}...' has {}",
                              longest_name, name.substr(0, 20), name.size()));
}

option_row name_row(const char* names, const char* help, std::string& into) {
  return checked(text_row(names, "NAME", help, into, completion::nothing),
                 [](const std::string& word) { static_cast<void>(full_name("", word)); });
}

option_row topic_row(const char* names, const char* help, std::string& into) {
  return checked(name_row(names, help, into), [](const std::string& word) {
    if (word.empty()) throw bad_value("a topic needs a name; 'off' is for none");
  });
}

option_row frame_name_row(std::string_view name, std::string& into) {
  return checked(row_of(name, into), [](const std::string& word) {
    if (word.empty()) throw bad_value("a frame needs a name");
    check_length(word);
  });
}

option_rows topic_rows(ros2_options& options) {
  topic_names& topics = options.topics;
  const option_row node_row =
      checked(text_row("--node-name", "NAME", "Name of the node (g4lidar)", options.node,
                       completion::nothing),
              [](const std::string& word) {
                check_length(word);
                if (!is_lidar_name(word))
                  throw bad_value(in_quotes(word) + " is not the name of a node");
              });
  return in_group(
      "Topics and frames",
      {name_row("--namespace", "Namespace of the topics (/)", options.name_space), node_row,
       topic_row("--scan-topic", "LaserScan messages; off: none (scan)", topics.scan),
       topic_row("--points-topic", "PointCloud2 messages; off: none (points)", topics.points),
       topic_row("--diagnostics-topic", "DiagnosticArray messages; off: none (/diagnostics)",
                 topics.diagnostics),
       topic_row("--odometry-topic", "Odometry, published or subscribed; off: none (odom)",
                 topics.odometry),
       topic_row("--tf-topic", "Frames that move; off: none (/tf)", topics.tf),
       topic_row("--tf-static-topic", "Places of lidars; off: none (/tf_static)", topics.tf_static),
       topic_row("--run-topic", "Bool: rest or turn the motor; off: none (NODE/run)", topics.run),
       frame_name_row("frame_id", options.frames.lidar),
       frame_name_row("base_frame", options.frames.robot),
       frame_name_row("odometry_frame", options.frames.odometry)});
}

option_rows scan_rows(ros2_options& options) {
  return in_group("Scans", {row_of("order", options.order), row_of("grid", options.bins),
                            merge_row(options.merges)});
}

option_rows network_rows(ros2_options& options) {
  network_options& transport = options.transport;
  return in_group(
      "Network",
      {value_row("--domain", "N", "ROS 2 domain (ROS_DOMAIN_ID, or 0)", transport.domain,
                 [](const std::string& word) { return number_of(word, 0U, 232U); }),
       text_row("--interface", "NAME", "Network interface or its address (any)",
                transport.interface, completion::nothing),
       choice_row("--qos", "Reliability of scans and points (reliable)", transport.is_reliable,
                  choices<bool>{{"reliable", true}, {"best-effort", false}}),
       number_row("--depth", "N", "Messages that wait for a slow subscriber (5)", transport.depth,
                  1, 10'000),
       choice_row("--announce", "Announce the node to ROS 2 up to humble, or from iron on (auto)",
                  transport.announced,
                  choices<announced_form>{{"auto", announced_form::automatic},
                                          {"none", announced_form::none},
                                          {"humble", announced_form::humble},
                                          {"iron", announced_form::iron}})});
}

option_rows device_and_player_rows(ros2_options& options) {
  option_row set{
      "--set", "NAME=VALUE", "Set the lidar at the start: frequency=10; may be repeated",
      [&into = options.settings](const std::string& word) { into.push_back(change_of(word)); }};
  set.complete = completion::setting;
  set.repeatable = true;
  return joined(in_group("Device", joined(set, row_of("standby", options.is_standby))),
                device_rows(options.common),
                player_rows(options.source.playback.speed, options.source.playback.loop));
}

/// Refuses two uses of one topic, which can have only one type.
void check_topics(const ros2_options& options, const std::vector<named_source>& lidars) {
  const topic_names& topics = options.topics;
  const std::array<std::pair<const char*, std::string_view>, 4> wanted{
      {{"--scan-topic", topics.scan},
       {"--points-topic", topics.points},
       {"--diagnostics-topic", topics.diagnostics},
       {"--odometry-topic", topics.odometry}}};
  std::map<std::string, std::string_view> owners{{"/clock", "rosgraph_msgs"}};
  const auto own = [&owners](std::string_view option, std::string_view space,
                             std::string_view name) {
    if (name == "off") return;
    const std::string topic = full_name(space, name);
    const auto [at, is_new] = owners.emplace(topic, option);
    if (is_new || at->second == option) return;
    throw bad_value(fmt::format("{}: {} is the topic of {}", option, topic, at->second));
  };
  own("--tf-topic", options.name_space, topics.tf);
  own("--tf-static-topic", options.name_space, topics.tf_static);
  own("--run-topic", options.name_space, run_topic(options));
  for (const named_source& lidar : lidars) {
    const std::string space = full_name(options.name_space, lidar.name);
    for (const auto& [option, name] : wanted) own(option, space, name);
  }
}

}  // namespace

std::string full_name(std::string_view name_space, std::string_view name) {
  std::string made(name.starts_with('/') ? "" : name_space);
  if (!made.empty() && !made.starts_with('/')) made.insert(0, "/");
  while (made.ends_with('/')) made.pop_back();
  if (!name.empty() && !name.starts_with('/')) made += '/';
  made += name;
  check_length(made);
  for (std::size_t at = 0; at < made.size();) {
    const std::size_t end = std::min(made.find('/', at + 1), made.size());
    const std::string_view token = std::string_view(made).substr(at + 1, end - at - 1);
    if ((!is_lidar_name(token) && made != "/") || token.find("__") != std::string_view::npos) {
      throw bad_value(in_quotes(std::string(name)) +
                      " is not a name of ROS 2: letters, digits, single _ and / between them");
    }
    at = end;
  }
  return made;
}

std::string frame_of(const ros2_options& options, std::string_view lidar) {
  std::string made = options.frames.lidar;
  if (!lidar.empty()) made.insert(made.rfind('/') + 1, std::string(lidar) + "_");
  return made;
}

std::string run_topic(const ros2_options& options) {
  return options.topics.run.empty() ? options.node + "/run" : options.topics.run;
}

std::vector<named_source> sources_of(const ros2_options& options) {
  std::vector<named_source> made = named_sources(options.sources, options.mounts, options.merges);
  check_topics(options, made);
  return made;
}

option_rows ros2_rows(const std::shared_ptr<ros2_options>& shared) {
  ros2_options& options = *shared;
  return joined(topic_rows(options), scan_rows(options),
                in_group("Motion of the robot", {named_mount_row(options.mounts),
                                                 row_of("deskew", options.common.deskew)}),
                joined(filter_rows(options.common), near_row(options.common.marks.near),
                       grid_rows(options.common.grid)),
                network_rows(options), device_and_player_rows(options),
                in_group("End condition", {duration_row(options.common)}));
}

}  // namespace g4_tool
