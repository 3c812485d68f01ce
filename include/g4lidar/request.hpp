// SPDX-License-Identifier: MIT
// What can be asked of a device, and the forms that an outcome takes.
#pragma once

#include <cstdint>
#include <variant>

#include "g4lidar/command.hpp"
#include "g4lidar/response.hpp"

namespace g4lidar {

/// A scan frequency as the device counts it, in 0.01 Hz.
struct scan_frequency {
  std::uint16_t chz;
  friend constexpr bool operator==(scan_frequency, scan_frequency) noexcept = default;
};

/// The four steps of the scan frequency.
enum class frequency_step : std::uint8_t {
  up_0_1_hz = static_cast<std::uint8_t>(command::frequency_up_0_1_hz),
  down_0_1_hz = static_cast<std::uint8_t>(command::frequency_down_0_1_hz),
  up_1_hz = static_cast<std::uint8_t>(command::frequency_up_1_hz),
  down_1_hz = static_cast<std::uint8_t>(command::frequency_down_1_hz),
};

/// The kinds of request.
enum class ask : std::uint8_t {
  device_info,
  health,
  get_low_power,
  set_low_power,
  get_direction,
  set_direction,
  get_scan_frequency,
  step_scan_frequency,
  set_scan_frequency,
  set_constant_frequency,
  get_ranging,
  set_ranging,
  set_protection,
  restart,
  start,
  stop,
};

/// One request. Made by the functions below, in which every value has its own type.
struct request {
  ask what;
  std::uint16_t value = 0;  ///< What to set; 0 where nothing is set.
  friend constexpr bool operator==(const request&, const request&) noexcept = default;
};

namespace requests {

/// Answered with a device_information.
[[nodiscard]] constexpr request device_info() noexcept { return {ask::device_info}; }
/// Answered with a health. Asks `91`, and `92` where that is not answered.
[[nodiscard]] constexpr request health() noexcept { return {ask::health}; }
/// Whether the motor rests when idle: a low_power.
[[nodiscard]] constexpr request get_low_power() noexcept { return {ask::get_low_power}; }
/// Sets that.
[[nodiscard]] constexpr request set(low_power wanted) noexcept {
  return {ask::set_low_power, static_cast<std::uint16_t>(wanted)};
}
/// Which way it turns: a motor_direction. Old firmware may not answer.
[[nodiscard]] constexpr request get_direction() noexcept { return {ask::get_direction}; }
/// Sets that.
[[nodiscard]] constexpr request set(motor_direction wanted) noexcept {
  return {ask::set_direction, static_cast<std::uint16_t>(wanted)};
}
/// The scan frequency that is set, not the one that is measured: a scan_frequency.
[[nodiscard]] constexpr request get_scan_frequency() noexcept { return {ask::get_scan_frequency}; }
/// One step. Answered with the frequency that is set afterwards, which at the end of the device's
/// range is the one from before.
[[nodiscard]] constexpr request step(frequency_step by) noexcept {
  return {ask::step_scan_frequency, static_cast<std::uint16_t>(by)};
}
/// Steps until the frequency is within 0.05 Hz of `wanted` or moves no further; answered with the one
/// reached.
[[nodiscard]] constexpr request set(scan_frequency wanted) noexcept {
  return {ask::set_scan_frequency, wanted.chz};
}
/// Sets whether it holds its frequency, which cannot be asked for.
[[nodiscard]] constexpr request set(constant_frequency wanted) noexcept {
  return {ask::set_constant_frequency, static_cast<std::uint16_t>(wanted)};
}
/// Samples a second: a ranging_frequency.
[[nodiscard]] constexpr request get_ranging() noexcept { return {ask::get_ranging}; }
/// Steps round until the wanted ranging frequency is set.
[[nodiscard]] constexpr request set(ranging_frequency wanted) noexcept {
  return {ask::set_ranging, static_cast<std::uint16_t>(wanted)};
}
/// Turns the protection over until the device says it is as wanted.
[[nodiscard]] constexpr request set(power_down_protection wanted) noexcept {
  return {ask::set_protection, static_cast<std::uint16_t>(wanted)};
}
/// Restarts the device and waits until it answers again.
[[nodiscard]] constexpr request restart() noexcept { return {ask::restart}; }
/// Answered when the device has said that it starts, or its first packet has come.
[[nodiscard]] constexpr request start() noexcept { return {ask::start}; }
/// Answered when the line has fallen silent.
[[nodiscard]] constexpr request stop() noexcept { return {ask::stop}; }

}  // namespace requests

/// What became of a request.
enum class verdict : std::uint8_t {
  answered,        ///< `outcome::value` holds the answer; nothing where none is due.
  not_reached,     ///< The device would not go as far as wanted; `value` is how far it went.
  timed_out,       ///< No believable answer, after all that may be repeated was.
  still_scanning,  ///< The device did not stop scanning, so nothing could be asked.
};

/// What came from the device while a request was under way.
struct heard_from_device {
  std::uint32_t skipped_bytes = 0;  ///< Bytes that belong to no frame.
  std::uint32_t responses = 0;
  std::uint32_t packets = 0;
  friend constexpr bool operator==(const heard_from_device&,
                                   const heard_from_device&) noexcept = default;
};

/// An answer, in the type of what was asked; for start, stop and restart there is none.
using answer =
    std::variant<std::monostate, device_information, health, low_power, motor_direction,
                 scan_frequency, constant_frequency, ranging_frequency, power_down_protection>;

/// How a request has ended.
struct outcome {
  request asked;
  verdict how = verdict::answered;
  answer value{};
  std::uint8_t retries = 0;        ///< Commands sent again, those that clear the line not counted.
  std::uint8_t wrong_answers = 0;  ///< Answers that cannot be the ones to what was asked.
  heard_from_device heard{};

  /// Whether not a single byte came.
  [[nodiscard]] constexpr bool heard_nothing() const noexcept {
    return heard == heard_from_device{};
  }
  /// Whether bytes came, and no frame among them: most likely the baud rate is another.
  [[nodiscard]] constexpr bool heard_noise_only() const noexcept {
    return heard.skipped_bytes > 0 && heard.responses == 0 && heard.packets == 0;
  }
  friend constexpr bool operator==(const outcome&, const outcome&) noexcept = default;
};

/// Why a request is not taken.
enum class refusal : std::uint8_t {
  busy,      ///< Another request is under way, or its outcome has not been fetched.
  scanning,  ///< Any command but start and stop would disturb the running scan.
};

/// Whether a request may stop a running scan.
enum class while_scanning : std::uint8_t {
  refuse,
  stop_and_resume,  ///< Stop, ask, and start again; the outcome comes when the scan runs again.
};

/// What a session has to tell that nobody asked for.
enum class notice : std::uint8_t {
  none,
  found_scanning,       ///< Packets came though no scan had been started; the device is stopped.
  protection_starved,   ///< The caller looked too late to feed the protection; started again.
  protection_found_on,  ///< The scan ended as if unfed; started again, and fed from now on.
  restarted,            ///< The scan ended by itself for another reason; started again.
  stalled,  ///< The scan ended by itself, or never sent a packet, and not even a start again helped:
            ///< given up. A device with too little power for its motor does this.
};

}  // namespace g4lidar
