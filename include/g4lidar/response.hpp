// SPDX-License-Identifier: MIT
// A reply on the wire: its header, the contents that are possible, and what they mean.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "g4lidar/bytes.hpp"
#include "g4lidar/frame_check.hpp"

namespace g4lidar {

/// Bytes of a reply before its content: start, length and mode, type code.
inline constexpr std::size_t response_header_size = 7;
/// The longest content of a reply, the device information.
inline constexpr std::size_t max_response_content = 20;
/// The two bytes that every reply begins with.
inline constexpr std::array<std::uint8_t, 2> response_start{0xA5, 0x5A};

/// The mode of a reply, the top two bits of its sixth byte. (protocol: Commands, reply header)
enum class response_mode : std::uint8_t { single = 0, continuous = 1 };

/// What a reply can be told to be by itself. What a byte or a frequency *means* follows from the
/// command that was sent. (protocol: Commands)
enum class response_kind : std::uint8_t {
  scan_started,  ///< The header before the endless packets; it has no content.
  device_info,   ///< 20 bytes.
  health,        ///< 3 bytes.
  byte,          ///< One byte, 0 to 2.
  frequency,     ///< Four bytes: Hz x 100.
};

/// The seven fixed bytes in front of a kind of reply, and the bytes of content behind them.
struct response_layout {
  response_kind kind;
  std::array<std::uint8_t, response_header_size> header;
  std::uint8_t content;
};

/// Every reply there is. The scan header's length field says 5 and is to be ignored.
inline constexpr std::array<response_layout, 5> response_layouts{{
    {response_kind::scan_started, {0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81}, 0},
    {response_kind::device_info, {0xA5, 0x5A, 0x14, 0x00, 0x00, 0x00, 0x04}, 20},
    {response_kind::health, {0xA5, 0x5A, 0x03, 0x00, 0x00, 0x00, 0x06}, 3},
    {response_kind::byte, {0xA5, 0x5A, 0x01, 0x00, 0x00, 0x00, 0x04}, 1},
    {response_kind::frequency, {0xA5, 0x5A, 0x04, 0x00, 0x00, 0x00, 0x04}, 4},
}};

/// The highest frequency that a reply can hold, in 0.01 Hz.
inline constexpr std::uint32_t max_frequency_chz = 2000;

/// Whether byte `at` of a content of this kind is possible, given the bytes before it. *Pure.*
/// (protocol: Commands, a reply is believed only if ...)
[[nodiscard]] constexpr bool is_possible(response_kind kind, bytes content,
                                         std::size_t at) noexcept {
  const std::uint8_t value = content[at];
  switch (kind) {
    case response_kind::scan_started:
      return false;
    case response_kind::device_info:
      return at < 4 || value <= 9;  // the serial number is one decimal digit a byte
    case response_kind::health:
      return at > 0 || value <= 2;
    case response_kind::byte:
      return value <= 2;
    case response_kind::frequency:
      if (at == 0) return true;
      if (at == 1) return load_u16(content, 0) <= max_frequency_chz;
      return value == 0;
  }
  return false;
}

/// Which of the layouts has this length byte, by which the five differ; response_layouts.size() if
/// none has. *Pure.*
[[nodiscard]] constexpr std::size_t layout_of_length(std::uint8_t length) noexcept {
  std::size_t at = 0;
  while (at < response_layouts.size() && response_layouts[at].header[2] != length) ++at;
  return at;
}

/// Whether a reply stands at the front of `data`: one of the headers above and a possible content,
/// each byte held against them as soon as it is there. *Pure.*
[[nodiscard]] constexpr frame_check check_response(bytes data) noexcept {
  const std::size_t have = data.size();
  const auto refused_at = [](std::size_t at) {
    return frame_check{frame_state::bad_header, at + 1};
  };
  if (have > 0 && data[0] != response_start[0]) return refused_at(0);
  if (have > 1 && data[1] != response_start[1]) return refused_at(1);
  if (have < 3) return {frame_state::incomplete, have + 1};
  const std::size_t which = layout_of_length(data[2]);
  if (which == response_layouts.size()) return refused_at(2);
  const response_layout& layout = response_layouts[which];
  for (std::size_t at = 3; at < response_header_size && at < have; ++at) {
    if (data[at] != layout.header[at]) return refused_at(at);
  }
  const std::size_t size = response_header_size + layout.content;
  for (std::size_t at = response_header_size; at < size && at < have; ++at) {
    const std::size_t in_content = at - response_header_size;
    if (!is_possible(layout.kind, data.subspan(response_header_size), in_content)) {
      return refused_at(at);
    }
  }
  if (have < size) return {frame_state::incomplete, have + 1};
  return {frame_state::valid, size};
}

/// What the device says of itself, interpreted. (protocol: Commands, device information)
struct device_information {
  std::uint8_t model;           ///< 5 is a G4.
  std::uint8_t firmware_major;  ///< The third byte on the wire.
  std::uint8_t firmware_minor;  ///< The second byte on the wire.
  std::uint8_t hardware;
  std::array<char, 16> serial_digits;  ///< '0' to '9'; not terminated.

  /// The serial number; good as long as this structure.
  [[nodiscard]] constexpr std::string_view serial_number() const& noexcept {
    return {serial_digits.data(), serial_digits.size()};
  }
  /// It would point into a structure that is gone.
  std::string_view serial_number() const&& = delete;

  friend constexpr bool operator==(const device_information&, const device_information&) = default;
};

/// The model number of a G4.
inline constexpr std::uint8_t model_g4 = 5;

/// How the device says it is.
enum class health_status : std::uint8_t { ok = 0, warning = 1, error = 2 };

/// The device's health. The meaning of the error code's bits is not known.
struct health {
  health_status status;
  std::uint16_t error_code;

  friend constexpr bool operator==(const health&, const health&) = default;
};

/// A valid reply, seen where it lies; it lives as long as its bytes stay untouched.
class response_view {
 public:
  /// The reply that `frame` holds from its first byte to its last, or nothing.
  [[nodiscard]] static constexpr std::optional<response_view> from(bytes frame) noexcept {
    const frame_check check = check_response(frame);
    if (check.state != frame_state::valid || check.size != frame.size()) return std::nullopt;
    return response_view(frame);
  }
  /// A view of bytes that die with the call would dangle.
  template <dying_owner Owner>
  static constexpr std::optional<response_view> from(Owner&&) = delete;

  /// All bytes of the reply; good as long as those that the view was made from.
  [[nodiscard]] constexpr bytes data() const noexcept { return frame_; }
  /// The bytes behind the header, 0 to 20 of them; good as long as data().
  [[nodiscard]] constexpr bytes content() const noexcept {
    return frame_.subspan(response_header_size);
  }
  /// Whether one answer was sent or an endless stream begins. (protocol: Commands, reply header)
  [[nodiscard]] constexpr response_mode mode() const noexcept {
    return static_cast<response_mode>(frame_[5] >> 6);
  }
  /// The seventh byte: 04h, 06h or 81h. Several kinds share a code; kind() tells them apart.
  [[nodiscard]] constexpr std::uint8_t type_code() const noexcept { return frame_[6]; }
  /// What the reply is, by its length byte.
  [[nodiscard]] constexpr response_kind kind() const noexcept {
    return response_layouts[layout_of_length(frame_[2])].kind;  // there is one: it was checked
  }

  /// The device information, if that is what this reply holds.
  [[nodiscard]] constexpr std::optional<device_information> as_device_info() const noexcept {
    if (kind() != response_kind::device_info) return std::nullopt;
    const bytes raw = content();
    device_information info{raw[0], raw[2], raw[1], raw[3], {}};
    for (std::size_t i = 0; i < info.serial_digits.size(); ++i) {
      info.serial_digits[i] = static_cast<char>('0' + raw[4 + i]);
    }
    return info;
  }
  /// The health, if that is what this reply holds.
  [[nodiscard]] constexpr std::optional<health> as_health() const noexcept {
    if (kind() != response_kind::health) return std::nullopt;
    return health{static_cast<health_status>(content()[0]), load_u16(content(), 1)};
  }
  /// The single byte, if that is what this reply holds; see reply_byte in command.hpp.
  [[nodiscard]] constexpr std::optional<std::uint8_t> as_byte() const noexcept {
    if (kind() != response_kind::byte) return std::nullopt;
    return content()[0];
  }
  /// The scan frequency in 0.01 Hz, if that is what this reply holds.
  [[nodiscard]] constexpr std::optional<std::uint16_t> as_frequency_chz() const noexcept {
    if (kind() != response_kind::frequency) return std::nullopt;
    return load_u16(content(), 0);  // the upper half is 0 in a valid reply
  }

 private:
  friend class stream_parser;  // hands out views of frames that it has checked

  explicit constexpr response_view(bytes frame) noexcept : frame_(frame) {}

  bytes frame_;
};

}  // namespace g4lidar
