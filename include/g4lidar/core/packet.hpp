// SPDX-License-Identifier: MIT
// Packets on the wire, with points and with the clock of the device: layouts, checksums, and views that exist only if
// they are valid.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <type_traits>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/model.hpp"

namespace g4lidar {

/// The number of bytes of a packet before its samples.
inline constexpr std::size_t packet_header_size = 10;
/// The maximum number of samples in a packet of a G4, and of any model.
inline constexpr std::size_t max_samples = g4_format.max_samples;
/// The size of the longest packet of any model in bytes.
inline constexpr std::size_t max_packet_size = packet_header_size + 2 * max_samples;
/// The first two bytes of every packet.
inline constexpr std::array<std::uint8_t, 2> packet_start{0xAA, 0x55};
/// One turn in the angle unit of the protocol, 1/64 of a degree.
inline constexpr std::uint16_t turn_64ths = 360 * 64;

/// The size in bytes of a packet with `samples` samples.
[[nodiscard]] constexpr std::size_t packet_size(std::size_t samples,
                                                sample_layout layout = g4_layout) noexcept {
  return packet_header_size + sample_size(layout) * samples;
}

namespace detail {

/// The exclusive or of the words of the samples of 3 bytes in `data`, whose size is a multiple of 3:
/// of each first byte, and of the two behind it as a word. *Pure.*
[[nodiscard]] constexpr std::uint64_t folded_triples(bytes data) noexcept {
  // Eight samples at a time: their bytes are the first, the second and the third ones of samples by
  // their places modulo 3.
  std::array<std::uint64_t, 3> words{};
  std::size_t at = 0;
  for (; at + 24 <= data.size(); at += 24) {
    for (std::size_t i = 0; i < 3; ++i) words[i] ^= load_u64(data, at + 8 * i);
  }
  const auto thrice = [](std::uint64_t word) { return word ^ word >> 24 ^ word >> 48; };
  const std::uint64_t second = thrice(words[1]);  // its first byte is a third one
  const std::uint64_t third = thrice(words[2]);   // its first byte is a second one
  const std::uint64_t sum = thrice(words[0]) ^ (second >> 8 & 0xFFFFU) ^ second << 16 ^
                            (third >> 16 & 0xFFU) ^ third << 8;
  std::uint64_t folded = ((sum ^ sum >> 8) & 0xFFU) | (sum >> 8 & 0xFF00U);
  for (; at < data.size(); at += 3) {
    folded ^= static_cast<std::uint64_t>(data[at] ^ load_u16(data, at + 1));
  }
  return folded;
}

}  // namespace detail

/// The expected checksum of `packet`: the exclusive or of all its 16-bit words except the checksum
/// itself. Of a sample of 3 bytes, the first byte is a word with the upper byte 0. `packet` is
/// complete by its header. *Pure.* (protocol: Point packets, CS)
[[nodiscard]] constexpr std::uint16_t packet_checksum(bytes packet,
                                                      sample_layout layout = g4_layout) noexcept {
  const std::size_t end = packet.size();
  // The header is one 8-byte word: PH, CT | LSN << 8, FSA, LSA.
  std::uint64_t folded = load_u64(packet, 0);
  std::size_t at = packet_header_size;
  if (sample_size(layout) == 3) {
    folded ^= detail::folded_triples(packet.subspan(at));
    at = end;
  }
  for (; at + 8 <= end; at += 8) folded ^= load_u64(packet, at);
  for (; at + 2 <= end; at += 2) folded ^= load_u16(packet, at);
  folded ^= folded >> 32;
  folded ^= folded >> 16;
  return static_cast<std::uint16_t>(folded & 0xFFFFU);
}

/// Whether `data` begins with a packet of this format, maybe of one without samples. Each byte is checked
/// against the protocol as soon as it is available. *Pure.* (protocol: Point packets)
[[nodiscard]] constexpr wire_check check_packet(bytes data,
                                                sample_format format = g4_format) noexcept {
  const std::size_t have = data.size();
  const auto refused_at = [](std::size_t at) { return wire_check{wire_state::bad_header, at + 1}; };
  if (have > 0 && data[0] != packet_start[0]) return refused_at(0);
  if (have > 1 && data[1] != packet_start[1]) return refused_at(1);
  if (have > 3 && data[3] > format.max_samples) return refused_at(3);
  for (std::size_t low = 4; low <= 6; low += 2) {  // FSA, then LSA
    if (have > low && (data[low] & 1U) == 0) return refused_at(low);
    if (have > low + 1 && load_u16(data, low) >> 1 >= turn_64ths) return refused_at(low + 1);
  }
  if (have < 8) return {wire_state::incomplete, have + 1};
  const std::size_t size = packet_size(data[3], format.layout);
  if (have < size) return {wire_state::incomplete, size};
  const bool agrees = packet_checksum(data.first(size), format.layout) == load_u16(data, 8);
  return {agrees ? wire_state::valid : wire_state::bad_checksum, size};
}

/// A view of a valid packet with samples. A `packet_view` can only be created from bytes that passed
/// check_packet(); it is valid as long as these bytes do not change.
class packet_view {
 public:
  /// A view of `packet` if it is one valid packet of this format from its first to its last byte, and not
  /// longer than max_packet_size, or nothing.
  [[nodiscard]] static constexpr std::optional<packet_view> from(
      bytes packet, sample_format format = g4_format) noexcept {
    const wire_check check = check_packet(packet, format);
    if (check.state != wire_state::valid || check.size != packet.size() ||
        check.size > max_packet_size || packet[3] == 0) {
      return std::nullopt;
    }
    return packet_view(packet, format.layout);
  }
  /// Deleted: the bytes are destroyed at the end of the call.
  template <dying_owner Owner>
  static constexpr std::optional<packet_view> from(Owner&&, sample_format = g4_format) = delete;

  /// All bytes of the packet.
  [[nodiscard]] constexpr bytes data() const noexcept { return {data_, size_}; }
  /// How its samples are read.
  [[nodiscard]] constexpr sample_layout layout() const noexcept { return layout_; }

  /// The raw byte CT. Its bits 7:1 have a meaning in a zero packet only.
  [[nodiscard]] constexpr std::uint8_t ct() const noexcept { return data_[2]; }
  /// Whether a new revolution starts with the first sample of this packet. (protocol: CT)
  [[nodiscard]] constexpr bool is_zero() const noexcept { return (ct() & 1U) != 0; }
  /// The scan frequency that a zero packet reports, in 0.01 Hz; 0 if none is reported. CT has it in 0.1 Hz.
  [[nodiscard]] constexpr int reported_frequency_chz() const noexcept {
    return is_zero() ? 10 * (ct() >> 1) : 0;
  }

  /// LSN, 1 to 80.
  [[nodiscard]] constexpr std::size_t sample_count() const noexcept { return data_[3]; }
  /// The word of the range of sample `i`, 0 <= i < sample_count(): of a G4 in quarters of a
  /// millimetre, 0 to 3 for no return. See sample_layout.
  [[nodiscard]] constexpr std::uint16_t sample(std::size_t i) const noexcept {
    return load_u16(data(), packet_size(i + 1, layout_) - 2);
  }
  /// The bytes of sample `i` before the word of its range, as a number; 0 if there are none.
  [[nodiscard]] constexpr std::uint16_t intensity_word(std::size_t i) const noexcept {
    const std::size_t at = packet_size(i, layout_);
    const std::size_t size = sample_size(layout_);
    if (size == 2) return 0;
    return size == 3 ? data_[at] : load_u16(data(), at);
  }
  /// Writes the words of the ranges of all samples to the front of `out`, and zeros behind them.
  constexpr void copy_samples(std::span<std::uint16_t, max_samples> out) const noexcept {
    const std::size_t count = sample_count();
    if (std::is_constant_evaluated() || std::endian::native != std::endian::little ||
        sample_size(layout_) != 2) {
      for (std::size_t i = 0; i < count; ++i) out[i] = sample(i);
    } else {
      std::memcpy(out.data(), data_ + packet_header_size, 2 * count);
    }
    for (std::size_t i = count; i < max_samples; ++i) out[i] = 0;
  }

  /// The first sample's first-level angle, clockwise, in 1/64 of a degree, below 23040.
  [[nodiscard]] constexpr int first_angle_64ths() const noexcept {
    return load_u16(data(), 4) >> 1;
  }
  /// The last sample's first-level angle, clockwise, in 1/64 of a degree, below 23040.
  [[nodiscard]] constexpr int last_angle_64ths() const noexcept { return load_u16(data(), 6) >> 1; }
  /// The clockwise turn from the first angle to the last, in 1/64 of a degree. Negative only in a
  /// suspect packet: then it is the small turn back.
  [[nodiscard]] constexpr int span_64ths() const noexcept {
    const int way = last_angle_64ths() - first_angle_64ths();
    return way < 0 && wraps_through_zero() ? way + turn_64ths : way;
  }
  /// Whether the last angle is before the first without a wrap through zero: real devices send such
  /// packets while the motor changes its speed, and the angles of their samples are not known.
  /// (protocol: Point packets)
  [[nodiscard]] constexpr bool is_suspect() const noexcept { return span_64ths() < 0; }

 private:
  friend class stream_parser;  // creates views of packets that it has checked

  constexpr packet_view(bytes packet, sample_layout layout) noexcept
      : data_(packet.data()), size_(static_cast<std::uint16_t>(packet.size())), layout_(layout) {}

  [[nodiscard]] constexpr bool wraps_through_zero() const noexcept {
    return first_angle_64ths() > 270 * 64 && last_angle_64ths() < 90 * 64;
  }

  const std::uint8_t* data_;
  std::uint16_t size_;
  sample_layout layout_;
};

/// A view of a valid packet without samples (LSN 0): some X2 send them between the others. Valid as long as its bytes
/// do not change.
class empty_packet_view {
 public:
  /// All bytes of the packet.
  [[nodiscard]] constexpr bytes data() const noexcept { return packet_; }

 private:
  friend class stream_parser;  // creates views of packets that it has checked

  explicit constexpr empty_packet_view(bytes packet) noexcept : packet_(packet) {}

  bytes packet_;
};

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
