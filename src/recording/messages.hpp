// SPDX-License-Identifier: MIT
// What stands in the messages of a recording, and their schemas. (docs/recordings.md)
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "g4lidar/bytes.hpp"
#include "g4lidar/line_note.hpp"
#include "g4lidar/recorded_device.hpp"
#include "g4lidar/scan.hpp"
#include "record_text.hpp"

namespace g4lidar::mcap {

/// The channels of a recording; their numbers in a file are these.
enum class topic : std::uint16_t { from_device = 1, to_device = 2, notes = 3, scan = 4 };
inline constexpr std::size_t topic_count = 4;

struct schema_words {
  std::uint16_t id;
  std::string_view name;
  std::string_view text;
};
struct topic_words {
  topic id;
  std::string_view name;
  std::uint16_t schema;
};
[[nodiscard]] std::span<const schema_words> all_schemas() noexcept;
[[nodiscard]] std::span<const topic_words> all_topics() noexcept;

/// So much stands before the bytes of a line in a message.
inline constexpr std::size_t line_bytes_header_size = 4 + 8 + 4;

void put_line_bytes(record_text& out, bytes data, std::int64_t time_ns);
void put_note(record_text& out, const line_note& what, std::int64_t wall_ahead_ns);
/// `ranges` as fill_grid() fills them in the robot's frame.
void put_scan(record_text& out, std::span<const float> ranges, std::int64_t first_wall_ns,
              std::int64_t duration_ns, std::string_view frame_id);

/// A message of bytes: when they came, and the bytes, which are a view of `message`.
struct line_bytes {
  std::int64_t time_ns;
  bytes data;
};
[[nodiscard]] std::optional<line_bytes> line_bytes_from(bytes message) noexcept;
/// A view of `message`; nothing where it is none, or of a kind that is not known.
[[nodiscard]] std::optional<line_note> note_from(bytes message) noexcept;

/// A map of words to words, as metadata have it.
using word_map = std::vector<std::pair<std::string, std::string>>;
void put_map(record_text& out, const word_map& words);

inline constexpr std::string_view device_metadata = "g4lidar.device";
inline constexpr std::string_view digest_metadata = "g4lidar.digest";
[[nodiscard]] word_map words_of(const recorded_device& device);
/// What is not there, or makes no sense, is not known.
[[nodiscard]] recorded_device device_of(field_reader& map);

/// How a line stands, as its notes tell.
struct line_state {
  bool is_known = false;  ///< Anything has been told.
  bool is_open = false;
  bool delivers = true;
  std::uint32_t baud = 0;
  std::uint32_t samples_per_second = 0;
  std::array<char, 64> name{};
  std::uint8_t name_size = 0;

  void take(const line_note& what) noexcept;
  [[nodiscard]] line_note as_note(std::int64_t time_ns) const noexcept;
  [[nodiscard]] std::string_view line() const noexcept { return {name.data(), name_size}; }
};

}  // namespace g4lidar::mcap
