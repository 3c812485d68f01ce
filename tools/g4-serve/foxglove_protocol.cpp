// SPDX-License-Identifier: MIT
#include "foxglove_protocol.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "cli/logger.hpp"
#include "client_json.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/recording/raw_bytes.hpp"
#include "g4lidar/version.hpp"

namespace g4_tool {
namespace {

using ordered = nlohmann::ordered_json;

/// Requests longer than this subscribe to more than there is.
constexpr std::size_t most_entries = 64;

std::optional<foxglove_request> parse_subscribe(const nlohmann::json& object) {
  const auto all = object.find("subscriptions");
  if (all == object.end() || !all->is_array() || all->size() > most_entries) return std::nullopt;
  subscribe_request made;
  for (const nlohmann::json& each : *all) {
    if (!each.is_object() || !each.contains("id") || !each.contains("channelId")) {
      return std::nullopt;
    }
    const auto id = id_in(each.at("id"));
    const auto channel_id = id_in(each.at("channelId"));
    if (!id || !channel_id) return std::nullopt;
    made.entries.push_back({*id, *channel_id});
  }
  return made;
}

std::optional<foxglove_request> parse_unsubscribe(const nlohmann::json& object) {
  const auto all = object.find("subscriptionIds");
  if (all == object.end() || !all->is_array() || all->size() > most_entries) return std::nullopt;
  unsubscribe_request made;
  for (const nlohmann::json& each : *all) {
    const auto id = id_in(each);
    if (!id) return std::nullopt;
    made.ids.push_back(*id);
  }
  return made;
}

}  // namespace

std::string server_info_text(std::string_view session) {
  return json_line({{"op", "serverInfo"},
                    {"name", fmt::format("g4-serve {}.{}.{}", G4LIDAR_VERSION_MAJOR,
                                         G4LIDAR_VERSION_MINOR, G4LIDAR_VERSION_PATCH)},
                    {"capabilities", ordered::array()},
                    {"sessionId", session}});
}

std::string advertise_text() {
  const std::array<std::pair<std::string_view, message_schema>, channel_count> all{
      {{"/scan", laser_scan_schema()},
       {"/points", point_cloud2_schema()},
       {"/diagnostics", diagnostic_array_schema()},
       {recorded_bytes_topic, recorded_bytes_schema()}}};
  ordered channels = ordered::array();
  for (const auto& [topic, schema] : all) {
    channels.push_back({{"id", channels.size() + 1},
                        {"topic", topic},
                        {"encoding", "cdr"},
                        {"schemaName", schema.name},
                        {"schemaEncoding", "ros2msg"},
                        {"schema", schema.text}});
  }
  return json_line({{"op", "advertise"}, {"channels", channels}});
}

std::string foxglove_status_text(int level, std::string_view message) {
  return json_line({{"op", "status"}, {"level", level}, {"message", message}});
}

outgoing message_data(std::uint32_t subscription, std::int64_t stamp_ns,
                      const shared_bytes& payload) {
  outgoing made{.is_text = false, .payload = payload, .prefix_size = 13};
  made.prefix[0] = 1;
  for (unsigned i = 0; i < 4; ++i) {
    made.prefix[1 + i] = static_cast<std::uint8_t>(subscription >> (8 * i));
  }
  const auto stamp = static_cast<std::uint64_t>(stamp_ns);
  for (unsigned i = 0; i < 8; ++i) {
    made.prefix[5 + i] = static_cast<std::uint8_t>(stamp >> (8 * i));
  }
  return made;
}

std::optional<foxglove_request> parse_foxglove_request(std::string_view text) {
  const auto object = request_in(text);
  if (!object) return std::nullopt;
  const std::string op = object->at("op").get<std::string>();
  if (op == "subscribe") return parse_subscribe(*object);
  if (op == "unsubscribe") return parse_unsubscribe(*object);
  return other_request{op};
}

}  // namespace g4_tool
