// SPDX-License-Identifier: MIT
// Which requests a model has, which values they can have, and what the angles in its answers mean.
#pragma once

#include <cstdint>
#include <optional>

#include "g4lidar/core/model.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/core/response.hpp"

namespace g4lidar {

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
      return model.frequency.max_dhz != 0;
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
      return wanted.value >= 10 * model.frequency.min_dhz &&
             wanted.value <= 10 * model.frequency.max_dhz;
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
  const auto& [min_dhz, max_dhz, offset_chz, ct_offset, pin] = model.frequency;
  const int beyond_chz = offset_chz < 0 ? -offset_chz : 0;
  return chz && *chz >= 10 * min_dhz && *chz <= 10 * max_dhz + beyond_chz;
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
