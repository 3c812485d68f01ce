// SPDX-License-Identifier: MIT
// The contents of the messages of a recording, and their schemas. (docs/recordings.md)
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/recording/contents.hpp"
#include "g4lidar/scan.hpp"
#include "record_text.hpp"

namespace g4lidar::mcap {

/// The number of bytes before the recorded bytes in a message.
inline constexpr std::size_t recorded_bytes_header_size = 4 + 8 + 4;

void put_recorded_bytes(record_text& out, bytes data, std::int64_t time_ns);
void put_event(record_text& out, const recorded_event& event, std::int64_t wall_ahead_ns);

/// A message of bytes: their time, and the bytes, a view of `message`.
struct recorded_bytes {
  std::int64_t time_ns;
  bytes data;
};
[[nodiscard]] std::optional<recorded_bytes> recorded_bytes_from(bytes message) noexcept;
/// The time is the stamp of the message; nothing if it is another message, or invalid.
[[nodiscard]] std::optional<stamped_odometry> odometry_from(bytes message) noexcept;
/// A view of `message`; nothing if it is invalid, or of an unknown kind.
[[nodiscard]] std::optional<recorded_event> event_from(bytes message) noexcept;

/// Longer names of transports are cut to this.
inline constexpr std::size_t longest_name = 255;

/// The state of a transport, from its recorded events.
struct transport_state {
  bool is_known = false;  ///< Whether there was an event.
  bool is_open = false;
  bool delivers = true;
  std::uint32_t baud = 0;
  std::uint32_t sample_rate_hz = 0;
  std::array<char, longest_name> name{};
  std::uint8_t name_size = 0;
  std::optional<zero_angle> zero{};
  bool counts_times = false;

  void take(const recorded_event& what) noexcept;
  [[nodiscard]] recorded_event as_event(std::int64_t time_ns) const noexcept;
  [[nodiscard]] std::string_view transport_name() const noexcept {
    return {name.data(), name_size};
  }
};

}  // namespace g4lidar::mcap
