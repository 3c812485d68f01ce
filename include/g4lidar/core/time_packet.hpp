// SPDX-License-Identifier: MIT
// A time packet on the wire: newer devices of the family send their clock between point packets.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/wire_check.hpp"

namespace g4lidar {

/// The size of a time packet in bytes.
inline constexpr std::size_t time_packet_size = 8;
/// The first two bytes of every time packet.
inline constexpr std::array<std::uint8_t, 2> time_packet_start{0xAA, 0x66};

/// Whether `data` begins with a time packet. *Pure.* (protocol: Time packets)
[[nodiscard]] constexpr wire_check check_time_packet(bytes data) noexcept {
  for (std::size_t at = 0; at < time_packet_start.size() && at < data.size(); ++at) {
    if (data[at] != time_packet_start[at]) return {wire_state::bad_header, at + 1};
  }
  if (data.size() < time_packet_size) return {wire_state::incomplete, time_packet_size};
  std::uint8_t folded = 0;  // the checksum is that of the other bytes, so all of them give 0
  for (const std::uint8_t byte : data.first(time_packet_size)) folded ^= byte;
  return {folded == 0 ? wire_state::valid : wire_state::bad_checksum, time_packet_size};
}

/// A view of a valid time packet; valid as long as its bytes do not change.
class time_packet_view {
 public:
  /// A view of `packet` if it is one valid time packet from its first to its last byte, or nothing.
  [[nodiscard]] static constexpr std::optional<time_packet_view> from(bytes packet) noexcept {
    const wire_check check = check_time_packet(packet);
    if (check.state != wire_state::valid || check.size != packet.size()) return std::nullopt;
    return time_packet_view(packet);
  }
  /// Deleted: the bytes are destroyed at the end of the call.
  template <dying_owner Owner>
  static constexpr std::optional<time_packet_view> from(Owner&&) = delete;

  /// All bytes of the packet.
  [[nodiscard]] constexpr bytes data() const noexcept { return packet_; }
  /// The clock of the device in milliseconds; it wraps at 2^32.
  [[nodiscard]] constexpr std::uint32_t milliseconds() const noexcept {
    return load_u32(packet_, 3);
  }

 private:
  friend class stream_parser;  // creates views of packets that it has checked

  explicit constexpr time_packet_view(bytes packet) noexcept : packet_(packet) {}

  bytes packet_;
};

}  // namespace g4lidar
