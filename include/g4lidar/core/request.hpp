// SPDX-License-Identifier: MIT
// Requests to a device, each with the type of its answer, and their outcomes. Which requests a model has, which values
// they can have, and what the angles in its answers mean.
#pragma once

#include <cstdint>
#include <optional>
#include <variant>

#include "g4lidar/core/command.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/settings.hpp"

namespace g4lidar {

/// The four step sizes of the scan frequency.
enum class frequency_step : std::uint8_t {
  up_0_1_hz = static_cast<std::uint8_t>(command::frequency_up_0_1_hz),
  down_0_1_hz = static_cast<std::uint8_t>(command::frequency_down_0_1_hz),
  up_1_hz = static_cast<std::uint8_t>(command::frequency_up_1_hz),
  down_1_hz = static_cast<std::uint8_t>(command::frequency_down_1_hz),
};

/// The kinds of request.
enum class request_kind : std::uint8_t {
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
  get_sample_rate,
  set_sample_rate,
  set_protection,
  zero_angle,
  pitch,
  restart,
  start,
  stop,
};

/// One request. Made by the functions of namespace requests, where each value has a type of its own.
struct request {
  request_kind what;
  std::uint16_t value = 0;  ///< The value to set; 0 if the request sets nothing.
  friend constexpr bool operator==(const request&, const request&) noexcept = default;
};

/// A request whose answer is an `Answer`; void if there is only success or failure.
template <class Answer>
struct request_for : request {};

namespace requests {

/// Answer: a device_information.
[[nodiscard]] constexpr request_for<device_information> device_info() noexcept {
  return {{request_kind::device_info}};
}
/// Answer: a health. Sends `91`, and `92` if `91` is not answered.
[[nodiscard]] constexpr request_for<g4lidar::health> health() noexcept {
  return {{request_kind::health}};
}
/// Queries whether the motor stops when idle. Answer: a low_power.
[[nodiscard]] constexpr request_for<low_power> get_low_power() noexcept {
  return {{request_kind::get_low_power}};
}
/// Sets whether the motor stops when idle.
[[nodiscard]] constexpr request_for<low_power> set(low_power wanted) noexcept {
  return {{request_kind::set_low_power, static_cast<std::uint16_t>(wanted)}};
}
/// Queries the direction of the motor. Answer: a motor_direction. Old firmware may not answer.
[[nodiscard]] constexpr request_for<motor_direction> get_direction() noexcept {
  return {{request_kind::get_direction}};
}
/// Sets the direction of the motor.
[[nodiscard]] constexpr request_for<motor_direction> set(motor_direction wanted) noexcept {
  return {{request_kind::set_direction, static_cast<std::uint16_t>(wanted)}};
}
/// Queries the configured scan frequency, not the measured one. Answer: a scan_frequency.
[[nodiscard]] constexpr request_for<scan_frequency> get_scan_frequency() noexcept {
  return {{request_kind::get_scan_frequency}};
}
/// One step. Answer: the configured frequency after the step; at the end of the device's range it
/// is the same as before.
[[nodiscard]] constexpr request_for<scan_frequency> step(frequency_step by) noexcept {
  return {{request_kind::step_scan_frequency, static_cast<std::uint16_t>(by)}};
}
/// Steps until the frequency is within 0.05 Hz of `wanted` or does not change any more. Answer: the
/// frequency that was reached.
[[nodiscard]] constexpr request_for<scan_frequency> set(scan_frequency wanted) noexcept {
  return {{request_kind::set_scan_frequency, wanted.chz}};
}
/// Sets whether the lidar regulates its frequency; the protocol has no query for it.
[[nodiscard]] constexpr request_for<constant_frequency> set(constant_frequency wanted) noexcept {
  return {{request_kind::set_constant_frequency, static_cast<std::uint16_t>(wanted)}};
}
/// Queries the sample rate. Answer: a sample_rate.
[[nodiscard]] constexpr request_for<sample_rate> get_sample_rate() noexcept {
  return {{request_kind::get_sample_rate}};
}
/// Steps through the sample rates until the wanted one is set.
[[nodiscard]] constexpr request_for<sample_rate> set(sample_rate wanted) noexcept {
  return {{request_kind::set_sample_rate, static_cast<std::uint16_t>(to_hz(wanted))}};
}
/// Toggles the protection until the device reports the wanted state.
[[nodiscard]] constexpr request_for<power_down_protection> set(
    power_down_protection wanted) noexcept {
  return {{request_kind::set_protection, static_cast<std::uint16_t>(wanted)}};
}
/// Queries the direction of zero that a factory has measured. Answer: a zero_angle.
[[nodiscard]] constexpr request_for<g4lidar::zero_angle> zero_angle() noexcept {
  return {{request_kind::zero_angle}};
}
/// Queries the tilt of the beam. Answer: a pitch_angle.
[[nodiscard]] constexpr request_for<pitch_angle> pitch() noexcept {
  return {{request_kind::pitch}};
}
/// Restarts the device. Answered when the device replies again.
[[nodiscard]] constexpr request_for<void> restart() noexcept { return {{request_kind::restart}}; }
/// Answered when the device has confirmed the start, or its first packet has arrived.
[[nodiscard]] constexpr request start() noexcept { return {request_kind::start}; }
/// Answered when no more bytes arrive.
[[nodiscard]] constexpr request stop() noexcept { return {request_kind::stop}; }

}  // namespace requests

/// How a request ended.
enum class verdict : std::uint8_t {
  answered,     ///< `outcome::value` contains the answer, if the request has one.
  not_reached,  ///< The device did not reach the wanted value; `value` is the value that it reached.
  timed_out,    ///< No valid answer, after all permitted repetitions.
  still_scanning,  ///< The device did not stop scanning, so nothing could be sent.
};

/// What arrived from the device during a request.
struct heard_from_device {
  std::uint32_t skipped_bytes = 0;  ///< Bytes outside packets and responses.
  std::uint32_t responses = 0;
  std::uint32_t packets = 0;
  friend constexpr bool operator==(const heard_from_device&,
                                   const heard_from_device&) noexcept = default;
};

/// An answer, in the type of the request; start, stop and restart have none.
using answer = std::variant<std::monostate, device_information, health, low_power, motor_direction,
                            scan_frequency, constant_frequency, sample_rate, power_down_protection,
                            zero_angle, pitch_angle>;

/// The outcome of a request.
struct outcome {
  request asked;
  verdict how = verdict::answered;
  answer value{};
  std::uint8_t retries = 0;  ///< Commands that were repeated, without those that clear the link.
  std::uint8_t wrong_answers = 0;  ///< Answers that are impossible for the command.
  /// Start commands that were sent, for a start or to resume the scan. More than one: the device did not
  /// start at once, and may have restarted and lost its settings.
  std::uint8_t starts = 0;
  heard_from_device heard{};

  /// Whether not a single byte arrived.
  [[nodiscard]] constexpr bool heard_nothing() const noexcept {
    return heard == heard_from_device{};
  }
  /// Whether bytes arrived, but no packet or response: most likely the wrong baud rate.
  [[nodiscard]] constexpr bool heard_noise_only() const noexcept {
    return heard.skipped_bytes > 0 && heard.responses == 0 && heard.packets == 0;
  }
  friend constexpr bool operator==(const outcome&, const outcome&) noexcept = default;
};

/// Why a request is refused.
enum class refusal : std::uint8_t {
  busy,           ///< Another request is in progress, or its outcome has not been taken.
  scanning,       ///< Any command but start and stop would disturb the running scan.
  bad_setting,    ///< The model cannot have this value; see is_possible().
  not_supported,  ///< The model does not have the command; see has_request().
};

/// Whether a request may stop a running scan.
enum class while_scanning : std::uint8_t {
  refuse,
  stop_and_resume,  ///< Stop, send, and start again; the outcome is available when the scan runs again.
};

/// What a session reports without a request of the caller.
enum class notice : std::uint8_t {
  none,
  found_scanning,  ///< Packets arrived although no scan had been started; the device is stopped.
  protection_starved,   ///< A keep-alive was sent too late for the protection; started again.
  protection_found_on,  ///< The scan ended as if by protection; started again, with keep-alives.
  spinning_up,          ///< Started, and no packet has arrived yet; the session only waits.
  restarted,            ///< The scan ended by itself for another reason; started again.
  stalled,  ///< The scan ended by itself, or never sent a packet, and another start did not help: given up. A cause is insufficient power for the motor.
};

/// Whether lidars like `model` have the command of the request, as far as it is known. *Pure.* One-way
/// lidars have none, but can be started and stopped in the sense of the driver.
[[nodiscard]] constexpr bool has_request(const model& model, request_kind kind) noexcept {
  const bool is_run = kind == request_kind::start || kind == request_kind::stop;
  if (model.link == link_kind::one_way) return is_run;
  switch (kind) {
    case request_kind::get_low_power:
    case request_kind::set_low_power:
    case request_kind::get_direction:
    case request_kind::set_direction:
    case request_kind::set_constant_frequency:
      return model.has_motor_settings;
    case request_kind::get_scan_frequency:
    case request_kind::step_scan_frequency:
    case request_kind::set_scan_frequency:
      return model.frequency.max_chz != 0;
    case request_kind::get_sample_rate:
      return model.rates.is_settable || model.rates.nominal_hz == 0;
    case request_kind::set_sample_rate:
      return model.rates.is_settable;
    case request_kind::set_protection:
      return model.protection != presence::no;
    case request_kind::zero_angle:
      return model.zero_angle_divisor != 0;
    case request_kind::pitch:
      return model.has_pitch;
    default:
      return true;
  }
}

/// Whether a lidar like `model` can have the value: a frequency within its limits, one of its sample
/// rates, an enumerator of its type. *Pure.* (protocol: Commands)
[[nodiscard]] constexpr bool is_possible(const request& wanted,
                                         const model& model = g4_model) noexcept {
  switch (wanted.what) {
    case request_kind::set_scan_frequency:
      return wanted.value >= model.frequency.min_chz && wanted.value <= model.frequency.max_chz;
    case request_kind::step_scan_frequency:
      return wanted.value >= static_cast<std::uint16_t>(frequency_step::up_0_1_hz) &&
             wanted.value <= static_cast<std::uint16_t>(frequency_step::down_1_hz);
    case request_kind::set_sample_rate:
      return wanted.value != 0 && code_of_rate(model, wanted.value) < rate_count(model);
    case request_kind::set_low_power:
    case request_kind::set_direction:
    case request_kind::set_constant_frequency:
    case request_kind::set_protection:
      return wanted.value <= 1;
    default:
      return wanted.what <= request_kind::stop && wanted.value == 0;
  }
}

/// Whether this answer of a lidar like `model` can be a frequency, so that it is not certainly an angle: one
/// within the limits of the model, with the offset of its replies or without. *Pure.*
[[nodiscard]] constexpr bool may_be_frequency(const response_view& heard,
                                              const model& model) noexcept {
  const auto chz = heard.as_frequency_chz();
  const auto& [min_chz, max_chz, offset_chz, ct_offset, pin] = model.frequency;
  const int beyond_chz = offset_chz < 0 ? -offset_chz : 0;
  return chz && *chz >= min_chz && *chz <= max_chz + beyond_chz;
}

/// The answer of a lidar like `model` to command 93; nothing if it is no angle within a turn. *Pure.*
[[nodiscard]] constexpr std::optional<zero_angle> zero_angle_of(const response_view& heard,
                                                                const model& model) noexcept {
  const std::int32_t divisor = model.zero_angle_divisor;
  const std::optional<std::int32_t> value = heard.as_angle();
  if (divisor == 0 || !value || *value < -360 * divisor || *value > 360 * divisor) return {};
  return zero_angle{*value * (100 / divisor)};
}

/// The answer to command 98, in the same way. *Pure.*
[[nodiscard]] constexpr std::optional<pitch_angle> pitch_of(const response_view& heard) noexcept {
  const std::optional<std::int32_t> value = heard.as_angle();
  if (!value || *value < -36'000 || *value > 36'000) return {};
  return pitch_angle{*value};
}

}  // namespace g4lidar
