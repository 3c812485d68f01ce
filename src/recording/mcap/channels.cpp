// SPDX-License-Identifier: MIT
#include "channels.hpp"

#include <algorithm>

#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/recording/raw_bytes.hpp"
#include "messages.hpp"
#include "metadata.hpp"

namespace g4lidar::mcap {
namespace {

constexpr std::string_view recorded_bytes_text =
    R"(# Bytes that were read from, or sent to, a lidar together.
int64 monotonic_ns  # when, by the steady clock of the computer; the wall clock is the message's time
uint8[] data
)";

constexpr std::string_view recorded_event_schema =
    R"(# What happened on the transport to a lidar beside the bytes.
int64 monotonic_ns
int64 wall_ahead_ns  # wall clock - monotonic clock
uint32 baud
uint32 sample_rate_hz
uint32 unparsed  # bytes of the last reading that had not been parsed
uint32 events    # of the parser since the last reading
bool delivers    # whether packets make points from here on
string what      # opened, closed, begun, held, cut, gap, state
string reason
string name
bool has_zero_angle    # whether the next one is known; older recordings end before it
int32 zero_angle_cdeg  # what is added to each angle, in 0.01 degrees
bool counts_times      # whether times of points are counted from samples; older recordings end before it
)";

struct schema_words {
  std::uint16_t id;
  std::string_view name;
  std::string_view text;
};
constexpr std::uint16_t schema_count_of_all = 6;
std::span<const schema_words> all_schemas() noexcept {
  const auto words = [](std::uint16_t id, message_schema schema) {
    return schema_words{id, schema.name, schema.text};
  };
  static const std::array<schema_words, schema_count_of_all> schemas{{
      words(1, recorded_bytes_schema()),
      {2, "g4lidar_msgs/msg/RecordedEvent", recorded_event_schema},
      words(3, laser_scan_schema()),
      words(4, point_cloud2_schema()),
      words(5, odometry_schema()),
      words(6, tf_message_schema()),
  }};
  return schemas;
}

constexpr std::array<topic_words, topic_count> topics{{
    {channel_id::from_device, recorded_bytes_topic, 1},
    {channel_id::to_device, "/g4lidar/to_device", 1},
    {channel_id::events, "/g4lidar/events", 2},
    {channel_id::scan, "/scan", 3},
    {channel_id::points, "/points", 4},
    {channel_id::odometry, "/odom", 5},
    {channel_id::tf_static, "/tf_static", 6},
}};

/// Whether a channel of the set has this schema.
bool uses(const channel_set& set, std::uint16_t schema) noexcept {
  return std::ranges::any_of(
      topics, [&](const topic_words& of) { return of.schema == schema && set.has(of.id); });
}

}  // namespace

std::span<const topic_words> all_topics() noexcept { return topics; }

channel_set::channel_set(const recording_options& options)
    : scan_topic_(options.topic), points_topic_(options.points_topic) {
  if (!points_topic_.empty()) add(channel_id::points);
  if (options.mount) add(channel_id::tf_static);
  if (options.model != nullptr) model_ = options.model;
}

std::uint32_t channel_set::count() const noexcept {
  return static_cast<std::uint32_t>(std::ranges::count(is_in_, true));
}
std::uint16_t channel_set::schema_count() const noexcept {
  return static_cast<std::uint16_t>(std::ranges::count_if(
      all_schemas(), [&](const schema_words& schema) { return uses(*this, schema.id); }));
}

void channel_set::put_schemas(record_text& out, const channel_set* without) const {
  for (const schema_words& schema : all_schemas()) {
    if (!uses(*this, schema.id) || (without != nullptr && uses(*without, schema.id))) continue;
    const std::size_t record = out.begin(opcode::schema);
    out.put(schema.id);
    out.put(schema.name);
    out.put("ros2msg");
    out.put(schema.text);
    out.end(record);
  }
}

void channel_set::put_channels(record_text& out) const {
  for (const topic_words& channel : topics) {
    if (!has(channel.id)) continue;
    std::string name(channel.name);
    if (channel.id == channel_id::scan) name = scan_topic_;
    if (channel.id == channel_id::points) name = points_topic_;
    word_map words{{"offered_qos_profiles", ""}};
    if (channel.is_of_connection() && *model_ != g4_model) {
      name.insert(connection_prefix.size(), model_version);
      words.emplace_back(model_key, model_->word);
    }
    const std::size_t record = out.begin(opcode::channel);
    out.put(static_cast<std::uint16_t>(channel.id));
    out.put(channel.schema);
    out.put(std::string_view(name));
    out.put("cdr");
    put_map(out, words);
    out.end(record);
  }
}

// ---- reading --------------------------------------------------------------------------------------

void found_channels::take(field_reader record) {
  const auto id = record.take<std::uint16_t>();
  static_cast<void>(record.take<std::uint16_t>());
  std::string name(record.take_text());
  const std::string_view encoding = record.take_text();
  if (!record.is_good() || encoding != "cdr") return;
  constexpr std::string_view version_prefix = "/g4lidar/v";
  static_assert(version_prefix.starts_with(connection_prefix));
  const g4lidar::model* const stated =
      name.starts_with(version_prefix) ? model_in(record, name) : &g4_model;
  if (stated == nullptr) return;
  for (const topic_words& known : topics) {
    if (!known.is_read() || known.name != name) continue;
    if (known.is_of_connection() && !agrees(*stated)) return;
    ids_[index_of(known.id)] = id;
  }
}

/// Whether the model is that of the channels before, or there was none.
bool found_channels::agrees(const g4lidar::model& stated) {
  if (model_ == nullptr) model_ = &stated;
  if (*model_ == stated) return true;
  contradiction_ = std::string(model_->word).append(" and ").append(stated.word);
  return false;
}

/// The model in the metadata of a channel, whose name loses its version; null if the version or the model is not known.
const g4lidar::model* found_channels::model_in(field_reader metadata, std::string& name) {
  const std::string_view rest = std::string_view(name).substr(connection_prefix.size());
  const std::string word = word_in(metadata, model_key);
  const g4lidar::model* const stated =
      rest.starts_with(model_version) ? model_named(word) : nullptr;
  if (stated == nullptr) {
    refused_ = name + (word.empty() ? "" : " of the model " + word);
  } else {
    name.erase(connection_prefix.size(), model_version.size());
  }
  return stated;
}

bool found_channels::reads(std::uint16_t id) const noexcept {
  return std::ranges::any_of(ids_, [id](const auto& each) { return each == id; });
}

bool found_channels::has_connection() const noexcept {
  return std::ranges::any_of(
      topics, [this](const topic_words& each) { return each.is_of_connection() && has(each.id); });
}

payload_digest payload_of(bytes records) noexcept {
  payload_digest sum;
  field_reader rest(records);
  while (!rest.is_at_end()) {
    const auto kind = static_cast<opcode>(rest.take<std::uint8_t>());
    field_reader record(rest.take(rest.take<std::uint64_t>()));
    if (kind != opcode::message) continue;
    const auto id = static_cast<channel_id>(record.take<std::uint16_t>());
    static_cast<void>(record.take(message_header_size - sizeof(std::uint16_t)));
    if (id != channel_id::from_device && id != channel_id::to_device) continue;
    const auto way = id == channel_id::from_device ? direction::from_device : direction::to_device;
    if (const auto found = recorded_bytes_from(record.rest())) sum.add(way, found->data);
  }
  return sum;
}

}  // namespace g4lidar::mcap

g4lidar::message_schema g4lidar::recorded_bytes_schema() noexcept {
  return {"g4lidar_msgs/msg/RecordedBytes", mcap::recorded_bytes_text};
}
