// SPDX-License-Identifier: MIT
// The channels of a recording and their schemas. (docs/recordings.md)
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "g4lidar/core/model.hpp"
#include "g4lidar/recording/writer.hpp"
#include "record_text.hpp"

namespace g4lidar::mcap {

/// The channels, with their numbers in a file.
enum class channel_id : std::uint16_t {
  from_device = 1,
  to_device = 2,
  events = 3,
  scan = 4,
  points = 5,
  odometry = 6,
  tf_static = 7,
};
inline constexpr std::size_t topic_count = 7;
[[nodiscard]] constexpr std::size_t index_of(channel_id id) noexcept {
  return static_cast<std::size_t>(id) - 1;
}

struct topic_words {
  channel_id id;
  std::string_view name;
  std::uint16_t schema;

  [[nodiscard]] constexpr bool is_named_by_options() const noexcept {
    return id == channel_id::scan || id == channel_id::points;
  }
  /// Whether its messages are of the connection to the lidar: its name states the version.
  [[nodiscard]] constexpr bool is_of_connection() const noexcept {
    return index_of(id) < index_of(channel_id::scan);
  }
  /// Whether readers of recordings return its messages.
  [[nodiscard]] constexpr bool is_read() const noexcept {
    return is_of_connection() || id == channel_id::odometry;
  }
};
/// The begin of the names of these channels. What follows in a recording of another model than a G4 is
/// the version: readers that know G4s only do not find their channels, and refuse the file. These
/// channels then have the word of the model in their metadata.
inline constexpr std::string_view connection_prefix = "/g4lidar/";
inline constexpr std::string_view model_version = "v2/";
inline constexpr std::string_view model_key = "model";

[[nodiscard]] std::span<const topic_words> all_topics() noexcept;

/// The channels in a file, with their names.
class channel_set {
 public:
  channel_set() : channel_set(recording_options{}) {}
  /// Those that a recording with these options begins with.
  explicit channel_set(const recording_options& options);

  [[nodiscard]] bool has(channel_id id) const noexcept { return is_in_[index_of(id)]; }
  void add(channel_id id) noexcept { is_in_[index_of(id)] = true; }
  /// The model of the lidar.
  [[nodiscard]] const g4lidar::model& model() const noexcept { return *model_; }
  void set_model(const g4lidar::model& model) noexcept { model_ = &model; }
  [[nodiscard]] std::uint32_t count() const noexcept;
  [[nodiscard]] std::uint16_t schema_count() const noexcept;

  /// Their records, but for those that `without` has.
  void put_schemas(record_text& out, const channel_set* without = nullptr) const;
  void put_channels(record_text& out) const;

 private:
  std::array<bool, topic_count> is_in_{true, true, true, true};
  const g4lidar::model* model_ = &g4_model;
  std::string scan_topic_;
  std::string points_topic_;
};

/// The channels that a reader has found in a file, and the model that they state.
class found_channels {
 public:
  /// Takes the content of the record of a channel.
  void take(field_reader record);

  [[nodiscard]] bool has(channel_id channel) const noexcept {
    return ids_[index_of(channel)].has_value();
  }
  [[nodiscard]] bool is(channel_id channel, std::uint16_t id) const noexcept {
    return ids_[index_of(channel)] == id;
  }
  /// Whether readers return the messages of this channel.
  [[nodiscard]] bool reads(std::uint16_t id) const noexcept;
  /// Whether there are any of the connection to a lidar.
  [[nodiscard]] bool has_connection() const noexcept;
  [[nodiscard]] const g4lidar::model& model() const noexcept {
    return model_ != nullptr ? *model_ : g4_model;
  }
  /// The last one of a version or a model that is not known; empty: there was none.
  [[nodiscard]] const std::string& refused() const noexcept { return refused_; }
  /// "t-mini-pro and tg15": channels of the connection state both models; empty: all state the same.
  [[nodiscard]] const std::string& contradiction() const noexcept { return contradiction_; }

 private:
  [[nodiscard]] const g4lidar::model* model_in(field_reader metadata, std::string& name);
  [[nodiscard]] bool agrees(const g4lidar::model& stated);

  std::array<std::optional<std::uint16_t>, topic_count> ids_;
  const g4lidar::model* model_ = nullptr;  // null: none was stated yet
  std::string refused_;
  std::string contradiction_;
};

/// Of the messages of a chunk.
[[nodiscard]] payload_digest payload_of(bytes records) noexcept;

}  // namespace g4lidar::mcap
