// SPDX-License-Identifier: MIT
#include "command_words.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "g4lidar/command.hpp"

namespace g4_dump {
namespace {

using g4lidar::command;

constexpr std::array<std::pair<command, std::string_view>, 24> words{{
    {command::forced_stop, "forced stop"},
    {command::low_power_on, "low power on"},
    {command::low_power_off, "low power off"},
    {command::low_power_query, "low power?"},
    {command::motor_clockwise, "clockwise"},
    {command::motor_counter_clockwise, "counter-clockwise"},
    {command::motor_direction_query, "direction?"},
    {command::frequency_up_0_1_hz, "0.1 Hz up"},
    {command::frequency_down_0_1_hz, "0.1 Hz down"},
    {command::frequency_up_1_hz, "1 Hz up"},
    {command::frequency_down_1_hz, "1 Hz down"},
    {command::frequency_query, "scan frequency?"},
    {command::constant_frequency_on, "constant frequency on"},
    {command::constant_frequency_off, "constant frequency off"},
    {command::restart_old, "restart"},
    {command::start, "start"},
    {command::stop, "stop"},
    {command::restart, "restart"},
    {command::device_info, "device information?"},
    {command::health, "health?"},
    {command::health_vendor, "health?"},
    {command::ranging_next, "next ranging frequency"},
    {command::ranging_query, "ranging frequency?"},
    {command::protection_toggle, "protection on or off"},
}};

}  // namespace

std::string_view word_for_command(std::uint8_t code) noexcept {
  const auto* const found = std::find_if(words.begin(), words.end(), [code](const auto& entry) {
    return entry.first == static_cast<command>(code);
  });
  return found == words.end() ? "no command" : found->second;
}

}  // namespace g4_dump
