// SPDX-License-Identifier: MIT
// Every command of the protocol: its bytes, its reply, and when it may be sent.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "g4lidar/detail/api.hpp"

namespace g4lidar {

/// The first byte of every command.
inline constexpr std::uint8_t command_start = 0xA5;

/// The second byte of a command. (protocol: Commands)
enum class command : std::uint8_t {
  forced_stop = 0x00,  ///< Not in the manual; the vendor's software sends it before `stop`.
  low_power_on = 0x01,
  low_power_off = 0x02,
  low_power_query = 0x05,
  motor_clockwise = 0x06,
  motor_counter_clockwise = 0x07,
  motor_direction_query = 0x08,
  frequency_up_0_1_hz = 0x09,
  frequency_down_0_1_hz = 0x0A,
  frequency_up_1_hz = 0x0B,
  frequency_down_1_hz = 0x0C,
  frequency_query = 0x0D,
  constant_frequency_on = 0x0E,
  constant_frequency_off = 0x0F,
  restart_old = 0x40,  ///< Soft restart on old firmware.
  start = 0x60,
  stop = 0x65,
  restart = 0x80,
  device_info = 0x90,
  health = 0x91,            ///< According to the manual.
  health_vendor = 0x92,     ///< As all software of the vendor sends it; the same reply.
  zero_angle = 0x93,        ///< Not of a G4; see model::zero_angle_divisor.
  pitch = 0x98,             ///< Not of a G4; see model::has_pitch.
  sample_rate_next = 0xD0,  ///< Steps to the next of 4, 8, 9 kHz; after the last comes the first.
  sample_rate_query = 0xD1,
  protection_toggle = 0xD9,
};

/// The two bytes that go to the device. *Pure.*
[[nodiscard]] constexpr std::array<std::uint8_t, 2> encode(command code) noexcept {
  return {command_start, static_cast<std::uint8_t>(code)};
}

/// The reply to a command: a subset of response_kind, and none.
enum class reply : std::uint8_t { none, scan_started, device_info, health, byte, frequency, pitch };

/// The properties of a command that matter before it is sent.
struct command_traits {
  command code;
  reply answered_by;
  /// The only possible byte of a true answer, if the answer is fixed.
  std::optional<std::uint8_t> fixed_answer;
  /// Each copy that reaches the device changes its state: it must not be repeated blindly.
  bool moves_state;
  /// May be sent during a scan; other commands disturb the stream.
  bool allowed_while_scanning;
};

/// All commands.
inline constexpr std::array<command_traits, 26> commands{{
    {command::forced_stop, reply::none, {}, false, true},
    {command::low_power_on, reply::byte, 1, false, false},
    {command::low_power_off, reply::byte, 0, false, false},
    {command::low_power_query, reply::byte, {}, false, false},
    {command::motor_clockwise, reply::byte, 0, false, false},
    {command::motor_counter_clockwise, reply::byte, 1, false, false},
    {command::motor_direction_query, reply::byte, {}, false, false},
    {command::frequency_up_0_1_hz, reply::frequency, {}, true, false},
    {command::frequency_down_0_1_hz, reply::frequency, {}, true, false},
    {command::frequency_up_1_hz, reply::frequency, {}, true, false},
    {command::frequency_down_1_hz, reply::frequency, {}, true, false},
    {command::frequency_query, reply::frequency, {}, false, false},
    {command::constant_frequency_on, reply::byte, 1, false, false},
    {command::constant_frequency_off, reply::byte, 0, false, false},
    {command::restart_old, reply::none, {}, false, false},
    {command::start,
     reply::scan_started,
     {},
     false,
     true},  // sent again as keep-alive of the protection
    {command::stop, reply::none, {}, false, true},
    {command::restart, reply::none, {}, false, false},
    {command::device_info, reply::device_info, {}, false, false},
    {command::health, reply::health, {}, false, false},
    {command::health_vendor, reply::health, {}, false, false},
    {command::zero_angle, reply::frequency, {}, false, false},
    {command::pitch, reply::pitch, {}, false, false},
    {command::sample_rate_next, reply::byte, {}, true, false},
    {command::sample_rate_query, reply::byte, {}, false, false},
    {command::protection_toggle, reply::byte, {}, true, false},
}};

/// The properties of `code`; nothing for a byte that is no command. *Pure.*
[[nodiscard]] constexpr std::optional<command_traits> traits_of(command code) noexcept {
  for (const command_traits& traits : commands) {
    if (traits.code == code) return traits;
  }
  return std::nullopt;
}

}  // namespace g4lidar
