// SPDX-License-Identifier: MIT
// The rows of the table of settings.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "g4lidar/core/session/model_requests.hpp"
#include "g4lidar/setting_table.hpp"

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
  const bool is_set = each.frequency.max_dhz != 0;
  return !is_set || (10 * each.frequency.min_dhz >= least_of_all_chz &&
                     10 * each.frequency.max_dhz <= most_of_all_chz);
}));
inline constexpr std::array<setting_value, 2> directions{
    {{"cw", 1, motor_direction::clockwise}, {"ccw", 2, motor_direction::counter_clockwise}}};
/// The settings whose values are off and on.
template <class Setting>
constexpr std::array<setting_value, 2> switch_values{
    {{"off", 1, Setting::off}, {"on", 2, Setting::on}}};

inline constexpr std::array<setting_info, 6> setting_rows{{
    {.name = "sample_rate",
     .type = setting_type::whole,
     .unit = "Hz",
     .text = "samples per second",
     .change = request_kind::set_sample_rate,
     .query = requests::get_sample_rate(),
     .values = sample_rates},
    {.name = "frequency",
     .type = setting_type::decimal,
     .unit = "Hz",
     .text = "revolutions per second",
     .change = request_kind::set_scan_frequency,
     .query = requests::get_scan_frequency(),
     .values = {},
     .least = least_of_all_chz,
     .most = most_of_all_chz},
    {.name = "direction",
     .type = setting_type::word,
     .unit = "",
     .text = "direction of rotation, seen from above",
     .change = request_kind::set_direction,
     .query = requests::get_direction(),
     .values = directions},
    {.name = "constant",
     .type = setting_type::on_off,
     .unit = "",
     .text = "constant scan frequency",
     .change = request_kind::set_constant_frequency,
     .query = {},
     .values = switch_values<constant_frequency>},
    {.name = "idle",
     .type = setting_type::on_off,
     .unit = "",
     .text = "stop the motor while not scanning",
     .change = request_kind::set_low_power,
     .query = requests::get_low_power(),
     .values = switch_values<low_power>},
    {.name = "protection",
     .type = setting_type::on_off,
     .unit = "",
     .text = "stop 3 s after the last keep-alive of the host",
     .change = request_kind::set_protection,
     .query = {},
     .values = switch_values<power_down_protection>},
}};

}  // namespace g4lidar
