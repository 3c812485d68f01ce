// SPDX-License-Identifier: MIT
// The rows of the table of settings.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "g4lidar/core/request.hpp"
#include "g4lidar/options/option_table.hpp"

namespace g4lidar {

constexpr setting_value rate_of(std::string_view word, std::uint16_t hz) {
  return {word, hz, sample_rate{hz}};
}
/// Of all models whose rate can be set.
inline constexpr std::array sample_rates{
    rate_of("4k", 4000),    rate_of("6k", 6000),    rate_of("8k", 8000),    rate_of("9k", 9000),
    rate_of("10k", 10'000), rate_of("16k", 16'000), rate_of("18k", 18'000), rate_of("20k", 20'000)};
static_assert(std::ranges::all_of(models, [](const model& each) {
  return std::ranges::all_of(each.rates.entries, [&](const sample_rate_entry& rate) {
    const auto hz = static_cast<std::int32_t>(rate.hz);
    return !has_request(each, request_kind::set_sample_rate) || hz == 0 ||
           std::ranges::find(sample_rates, hz, &setting_value::number) != sample_rates.end();
  });
}));
/// The limits of the scan frequency of all models, in 0.01 Hz.
inline constexpr std::int32_t least_of_all_chz = 300;
inline constexpr std::int32_t most_of_all_chz = 1600;
static_assert(std::ranges::all_of(models, [](const model& each) {
  const bool is_set = each.frequency.max_chz != 0;
  return !is_set ||
         (each.frequency.min_chz >= least_of_all_chz && each.frequency.max_chz <= most_of_all_chz);
}));
inline constexpr std::array<setting_value, 2> directions{
    {{"cw", 1, motor_direction::clockwise}, {"ccw", 2, motor_direction::counter_clockwise}}};
/// The settings whose values are off and on.
template <class Setting>
constexpr std::array<setting_value, 2> switch_values{
    {{"off", 1, Setting::off}, {"on", 2, Setting::on}}};

inline constexpr std::array<setting_info, 6> setting_rows{{
    {"sample_rate", setting_type::whole, "Hz", "samples per second", request_kind::set_sample_rate,
     requests::get_sample_rate(), sample_rates},
    {"frequency",
     setting_type::decimal,
     "Hz",
     "revolutions per second",
     request_kind::set_scan_frequency,
     requests::get_scan_frequency(),
     {},
     least_of_all_chz,
     most_of_all_chz},
    {"direction", setting_type::word, "", "direction of rotation, seen from above",
     request_kind::set_direction, requests::get_direction(), directions},
    {"constant",
     setting_type::on_off,
     "",
     "constant scan frequency",
     request_kind::set_constant_frequency,
     {},
     switch_values<constant_frequency>},
    {"idle", setting_type::on_off, "", "stop the motor while not scanning",
     request_kind::set_low_power, requests::get_low_power(), switch_values<low_power>},
    {"protection",
     setting_type::on_off,
     "",
     "stop 3 s after the last keep-alive of the host",
     request_kind::set_protection,
     {},
     switch_values<power_down_protection>},
}};

}  // namespace g4lidar
