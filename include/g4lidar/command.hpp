// SPDX-License-Identifier: MIT
// Every command of the protocol: its bytes, its reply, and what may be done with it when.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace g4lidar {

/// The byte that every command begins with.
inline constexpr std::uint8_t command_start = 0xA5;

/// The second byte of a command. (protocol: Commands)
enum class command : std::uint8_t {
  forced_stop = 0x00,  ///< Not in the manual; vendor software sends it before `stop`.
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
  health = 0x91,         ///< As the manual has it.
  health_vendor = 0x92,  ///< As all vendor software sends it; the same reply.
  ranging_next = 0xD0,   ///< Steps to the next of 4, 8, 9 kHz and round again.
  ranging_query = 0xD1,
  protection_toggle = 0xD9,
};

/// The two bytes that go to the device. *Pure.*
[[nodiscard]] constexpr std::array<std::uint8_t, 2> encode(command code) noexcept {
  return {command_start, static_cast<std::uint8_t>(code)};
}

/// What answers a command. A subset of response_kind, and nothing at all.
enum class reply : std::uint8_t { none, scan_started, device_info, health, byte, frequency };

/// What is to be known of one command before it is sent.
struct command_traits {
  command code;
  reply answered_by;
  /// The only byte that a true answer can hold, where the answer is fixed.
  std::optional<std::uint8_t> fixed_answer;
  /// Each copy that reaches the device moves its state on: never to be sent again blindly.
  bool moves_state;
  /// May be sent while the device is scanning; anything else disturbs the stream.
  bool allowed_while_scanning;
};

/// All commands there are.
inline constexpr std::array<command_traits, 24> commands{{
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
    {command::start, reply::scan_started, {}, false, true},  // again, to feed the protection
    {command::stop, reply::none, {}, false, true},
    {command::restart, reply::none, {}, false, false},
    {command::device_info, reply::device_info, {}, false, false},
    {command::health, reply::health, {}, false, false},
    {command::health_vendor, reply::health, {}, false, false},
    {command::ranging_next, reply::byte, {}, true, false},
    {command::ranging_query, reply::byte, {}, false, false},
    {command::protection_toggle, reply::byte, {}, true, false},
}};

/// What is known of `code`; nothing for a byte that is no command. *Pure.*
[[nodiscard]] constexpr std::optional<command_traits> traits_of(command code) noexcept {
  for (const command_traits& traits : commands) {
    if (traits.code == code) return traits;
  }
  return std::nullopt;
}

/// Answers of one byte to 06, 07 and 08.
enum class motor_direction : std::uint8_t { clockwise = 0, counter_clockwise = 1 };
/// Answers of one byte to D0 and D1.
enum class ranging_frequency : std::uint8_t { khz_4 = 0, khz_8 = 1, khz_9 = 2 };
/// Answers of one byte to D9: which way the toggle has fallen.
enum class power_down_protection : std::uint8_t { on = 0, off = 1 };
/// Answers of one byte to 01, 02 and 05.
enum class low_power : std::uint8_t { off = 0, on = 1 };
/// Answers of one byte to 0E and 0F.
enum class constant_frequency : std::uint8_t { off = 0, on = 1 };

/// Ranging measurements a second. *Pure.*
[[nodiscard]] constexpr std::uint32_t samples_per_second(ranging_frequency frequency) noexcept {
  switch (frequency) {
    case ranging_frequency::khz_4:
      return 4000;
    case ranging_frequency::khz_8:
      return 8000;
    case ranging_frequency::khz_9:
      break;
  }
  return 9000;
}

/// A one-byte answer read as `Setting`, one of the five enumerations above; nothing where the byte
/// is none of its values. *Pure.*
template <class Setting>
[[nodiscard]] constexpr std::optional<Setting> reply_byte(std::uint8_t value) noexcept;

/// The same of the one setting that has three values.
template <>
constexpr std::optional<ranging_frequency> reply_byte(std::uint8_t value) noexcept {
  if (value > 2) return std::nullopt;
  return static_cast<ranging_frequency>(value);
}

/// The same of those that have two.
template <class Setting>
constexpr std::optional<Setting> reply_byte(std::uint8_t value) noexcept {
  if (value > 1) return std::nullopt;
  return static_cast<Setting>(value);
}

/// The lowest scan frequency that a G4 can be set to, in 0.01 Hz.
inline constexpr std::uint16_t min_scan_frequency_chz = 500;
/// The highest scan frequency that a G4 can be set to, in 0.01 Hz.
inline constexpr std::uint16_t max_scan_frequency_chz = 1200;

}  // namespace g4lidar
