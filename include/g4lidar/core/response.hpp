// SPDX-License-Identifier: MIT
// A response on the wire: its header, the possible contents, and their meaning.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/settings.hpp"

namespace g4lidar {

/// The number of bytes of a response before its content: start, length and mode, type code.
inline constexpr std::size_t response_header_size = 7;
/// The size of the longest content, the device information.
inline constexpr std::size_t max_response_content = 20;
/// The first two bytes of every response.
inline constexpr std::array<std::uint8_t, 2> response_start{0xA5, 0x5A};

/// The mode of a response, the top two bits of its sixth byte. (protocol: Commands, reply header)
enum class response_mode : std::uint8_t { single = 0, continuous = 1 };

/// The kinds of response that can be distinguished without the command. What a byte or a frequency
/// *means* depends on the command that was sent. (protocol: Commands)
enum class response_kind : std::uint8_t {
  scan_started,  ///< The header before the endless packets; without content.
  device_info,   ///< 20 bytes.
  health,        ///< 3 bytes.
  byte,          ///< One byte, 0 to 2; of some models 0 to 4.
  frequency,     ///< Four bytes: Hz x 100; to command 93 an angle.
  pitch,         ///< Four bytes: an angle.
};

/// The seven fixed bytes of a kind of response, and the number of content bytes behind them.
struct response_layout {
  response_kind kind;
  std::array<std::uint8_t, response_header_size> header;
  std::uint8_t content;
};

/// Every kind of response, in the order of their enumeration. The length field of the scan header is 5 and must be ignored.
inline constexpr std::array<response_layout, 6> response_layouts{{
    {response_kind::scan_started, {0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81}, 0},
    {response_kind::device_info, {0xA5, 0x5A, 0x14, 0x00, 0x00, 0x00, 0x04}, 20},
    {response_kind::health, {0xA5, 0x5A, 0x03, 0x00, 0x00, 0x00, 0x06}, 3},
    {response_kind::byte, {0xA5, 0x5A, 0x01, 0x00, 0x00, 0x00, 0x04}, 1},
    {response_kind::frequency, {0xA5, 0x5A, 0x04, 0x00, 0x00, 0x00, 0x04}, 4},
    {response_kind::pitch, {0xA5, 0x5A, 0x04, 0x00, 0x00, 0x00, 0x10}, 4},
}};

/// The highest frequency that a response can contain, in 0.01 Hz.
inline constexpr std::uint32_t max_frequency_chz = 2000;

/// How many bytes at the begin of `content`, of a response of this kind, are possible; `largest_byte` is the
/// largest content of one byte. *Pure.* (protocol: Commands, a reply is believed only if ...)
/// Not inlined: otherwise the parser spends an instruction more on each sample.
[[nodiscard, gnu::noinline]] constexpr std::size_t possible_bytes(
    response_kind kind, bytes content, std::uint8_t largest_byte = 2) noexcept {
  // How many bytes there are until the first one behind `begin` that is larger.
  const auto up_to_larger = [content](std::size_t begin, std::uint8_t largest) {
    std::size_t at = begin;
    while (at < content.size() && content[at] <= largest) ++at;
    return std::min(at, content.size());
  };
  switch (kind) {
    case response_kind::device_info:
      return up_to_larger(4, 9);  // each byte of the serial number is a decimal digit
    case response_kind::health:
      return content.empty() || content[0] <= 2 ? content.size() : 0;
    case response_kind::byte:
      return up_to_larger(0, largest_byte);
    case response_kind::frequency:
      if (content.size() > 1 && load_u16(content, 0) > max_frequency_chz) return 1;
      return up_to_larger(2, 0);
    case response_kind::scan_started:
    case response_kind::pitch:
      break;
  }
  return content.size();
}

/// The index of the first layout with this length byte, which differs in all but the last two;
/// response_layouts.size() if there is none. *Pure.*
[[nodiscard]] constexpr std::size_t layout_of_length(std::uint8_t length) noexcept {
  std::size_t at = 0;
  while (at < response_layouts.size() && response_layouts[at].header[2] != length) ++at;
  return at;
}

/// Whether `data` begins with a response: one of the headers above and a possible content. Each
/// byte is checked as soon as it is available. Only a model that `has_angles` answers with angles: of
/// four bytes, which are then not checked. `largest_byte` is the largest content of one byte. *Pure.*
[[nodiscard]] constexpr wire_check check_response(bytes data, bool has_angles = false,
                                                  std::uint8_t largest_byte = 2) noexcept {
  const std::size_t have = data.size();
  const auto refused_at = [](std::size_t at) { return wire_check{wire_state::bad_header, at + 1}; };
  if (have > 0 && data[0] != response_start[0]) return refused_at(0);
  if (have > 1 && data[1] != response_start[1]) return refused_at(1);
  if (have < 3) return {wire_state::incomplete, have + 1};
  const std::size_t which = layout_of_length(data[2]);
  if (which == response_layouts.size()) return refused_at(2);
  const response_layout& layout = response_layouts[which];
  const bool is_angle = has_angles && layout.kind == response_kind::frequency;
  for (std::size_t at = 3; at < response_header_size && at < have; ++at) {
    const bool is_pitch = is_angle && data[at] == response_layouts.back().header[at];
    if (data[at] != layout.header[at] && !is_pitch) return refused_at(at);
  }
  const std::size_t size = response_header_size + layout.content;
  if (have > response_header_size && !is_angle) {
    const bytes content =
        data.subspan(response_header_size, std::min(have, size) - response_header_size);
    const std::size_t possible = possible_bytes(layout.kind, content, largest_byte);
    if (possible < content.size()) return refused_at(response_header_size + possible);
  }
  if (have < size) return {wire_state::incomplete, have + 1};
  return {wire_state::valid, size};
}

/// A one-byte answer of a G4 as `Setting`, an enumeration of settings.hpp; nothing if the byte is not
/// one of its values. *Pure.*
template <class Setting>
[[nodiscard]] constexpr std::optional<Setting> reply_byte(std::uint8_t value) noexcept {
  if constexpr (std::is_same_v<Setting, sample_rate>) {
    constexpr std::array rates{sample_rate::khz_4, sample_rate::khz_8, sample_rate::khz_9};
    return value < rates.size() ? std::optional(rates[value]) : std::nullopt;
  }
  const auto setting = static_cast<Setting>(value);
  return is_valid(setting) ? std::optional(setting) : std::nullopt;
}

/// A view of a valid response; valid as long as its bytes do not change.
class response_view {
 public:
  /// A view of `response` if it is one valid response from its first to its last byte, or nothing.
  [[nodiscard]] static constexpr std::optional<response_view> from(
      bytes response, bool has_angles = false) noexcept {
    const wire_check check = check_response(response, has_angles);
    if (check.state != wire_state::valid || check.size != response.size()) return std::nullopt;
    return response_view(response);
  }
  /// Deleted: the bytes are destroyed at the end of the call.
  template <dying_owner Owner>
  static constexpr std::optional<response_view> from(Owner&&, bool has_angles = false) = delete;

  /// All bytes of the response; valid as long as the bytes of the view.
  [[nodiscard]] constexpr bytes data() const noexcept { return response_; }
  /// The bytes behind the header, 0 to 20; valid as long as data().
  [[nodiscard]] constexpr bytes content() const noexcept {
    return response_.subspan(response_header_size);
  }
  /// Whether this is a single answer or the begin of an endless stream. (protocol: Commands, reply
  /// header)
  [[nodiscard]] constexpr response_mode mode() const noexcept {
    return static_cast<response_mode>(response_[5] >> 6);
  }
  /// The seventh byte: 04h, 06h, 10h or 81h. Several kinds have the same code; kind() distinguishes
  /// them.
  [[nodiscard]] constexpr std::uint8_t type_code() const noexcept { return response_[6]; }
  /// The kind of the response, by its length byte, and pitch by its type.
  [[nodiscard]] constexpr response_kind kind() const noexcept {
    constexpr response_layout last = response_layouts.back();
    if (type_code() == last.header.back()) return last.kind;
    return response_layouts[layout_of_length(response_[2])].kind;  // always found: it was checked
  }

  /// The device information, if the response contains it.
  [[nodiscard]] constexpr std::optional<device_information> as_device_info() const noexcept {
    if (kind() != response_kind::device_info) return std::nullopt;
    const bytes raw = content();
    device_information info{raw[0], raw[2], raw[1], raw[3], {}};
    for (std::size_t i = 0; i < info.serial_digits.size(); ++i) {
      info.serial_digits[i] = static_cast<char>('0' + raw[4 + i]);
    }
    return info;
  }
  /// The health, if the response contains it.
  [[nodiscard]] constexpr std::optional<health> as_health() const noexcept {
    if (kind() != response_kind::health) return std::nullopt;
    return health{static_cast<health_status>(content()[0]), load_u16(content(), 1)};
  }
  /// The single byte, if the response contains one; see reply_byte().
  [[nodiscard]] constexpr std::optional<std::uint8_t> as_byte() const noexcept {
    if (kind() != response_kind::byte) return std::nullopt;
    return content()[0];
  }
  /// The scan frequency in 0.01 Hz, if the response can be one.
  [[nodiscard]] constexpr std::optional<std::uint16_t> as_frequency_chz() const noexcept {
    if (kind() != response_kind::frequency) return std::nullopt;
    if (load_u32(content(), 0) > max_frequency_chz) return std::nullopt;  // an angle
    return load_u16(content(), 0);
  }
  /// The number of four bytes, if the response contains one: of an angle, in the unit of its command.
  [[nodiscard]] constexpr std::optional<std::int32_t> as_angle() const noexcept {
    if (kind() != response_kind::frequency && kind() != response_kind::pitch) return std::nullopt;
    return static_cast<std::int32_t>(load_u32(content(), 0));
  }

 private:
  friend class stream_parser;  // creates views of responses that it has checked

  explicit constexpr response_view(bytes response) noexcept : response_(response) {}

  bytes response_;
};

}  // namespace g4lidar
