// SPDX-License-Identifier: MIT
// How a simulated G4 is: what stands in its memory, and which way each open question falls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "g4lidar/command.hpp"
#include "g4lidar/export.hpp"
#include "g4lidar/response.hpp"
#include "g4lidar/sim/scanner.hpp"

namespace g4lidar::sim {

/// What commands set, as it stands in the device. By default as a G4 comes.
struct device_settings {
  low_power idle_power = low_power::on;
  motor_direction direction = motor_direction::clockwise;
  std::uint16_t scan_frequency_chz = 700;
  constant_frequency constancy = constant_frequency::on;
  ranging_frequency ranging = ranging_frequency::khz_9;
  power_down_protection protection = power_down_protection::off;

  friend bool operator==(const device_settings&, const device_settings&) = default;
};

/// What a step of the scan frequency does that would lead beyond 5 or 12 Hz.
enum class at_limit : std::uint8_t {
  clamp,   ///< It goes to the limit.
  refuse,  ///< It goes nowhere.
};

/// What a command does that may not be sent while scanning.
enum class disturbance : std::uint8_t {
  mid_packet,  ///< Its answer comes in the middle of a packet.
  between,     ///< Its answer comes between two packets.
  drops,       ///< As mid_packet, and the rest of that packet is lost.
  ignored,     ///< Nothing: no answer, and it is not carried out.
};

/// Everything about a device that is no fault. By default a healthy G4, wherever that is known.
struct device_options {
  /// How it measures, and the seed of all that is random here. Its scan and ranging frequency are
  /// the device's own defaults; `start_deg` is not used: each start has a random angle.
  scanner_options scanner;
  /// What it answers to 90.
  device_information info{
      model_g4,
      3,
      2,
      3,
      {'2', '0', '2', '1', '1', '0', '1', '0', '0', '0', '0', '7', '0', '0', '7', '3'}};
  health condition{health_status::ok, 0};

  // The line.
  std::uint32_t baud = 230'400;
  /// How long bytes wait in the USB bridge, drawn for each batch. A fault `batch` overrides it.
  std::int64_t batch_min_ns = 0;
  std::int64_t batch_max_ns = 1'000'000;
  std::int64_t reaction_ns = 1'000'000;  ///< From a command's last byte to its effect and answer.

  // The motor.
  std::uint32_t acceleration_mhz_per_s = 14'000;  ///< Of the scan frequency; 7 Hz in half a second.
  std::int64_t standstill_ns = 60'000'000;        ///< Until the motor begins to move.
  /// How far the speed wanders to either side, in millionths, with and without constant frequency,
  /// and how long it takes there and back.
  std::uint32_t motor_drift_ppm = 2'000;
  std::uint32_t free_motor_drift_ppm = 30'000;
  std::int64_t motor_drift_period_ns = 20'000'000'000;
  /// What counter-clockwise does to the angles.
  turning counter_clockwise = turning::mirrored;

  // What healthy devices send beside the protocol.
  bool stray_after_start = true;  ///< A 00 after the scan header.
  bool stray_before_zero = true;  ///< A random byte before every zero packet.
  bool stop_truncates = true;     ///< A stop cuts the packet that is on the line.
  bool boot_text = true;          ///< ASCII after a restart and after power has come.
  bool boot_information = true;   ///< Then the device information, unasked.
  std::int64_t boot_ns = 400'000'000;

  // Open questions of the protocol.
  at_limit frequency_at_limit = at_limit::clamp;
  disturbance while_scanning = disturbance::mid_packet;
  bool settings_outlive_power = false;
  bool settings_outlive_restart = false;
  bool answers_direction = true;  ///< To 08.
  bool answers_health_91 = true;
  bool answers_health_92 = true;
  bool obeys_forced_stop = true;  ///< 00.
  bool obeys_restart_80 = true;
  bool obeys_restart_40 = true;
  bool error_refuses_start = false;     ///< With health error, 60 is not answered.
  bool start_again_answers = false;     ///< 60 while scanning brings another header.
  bool header_after_protection = true;  ///< 60 brings a header when the protection had stopped it.
  std::int64_t protection_ns = 3'000'000'000;

  // How it stands there at time 0: with power, idle, and booted long ago.
  device_settings initial;      ///< But for the two frequencies, which `scanner` has.
  bool boots_at_start = false;  ///< It gets its power at time 0.

  // What is kept for whoever asks; the oldest is lost beyond that.
  std::size_t truth_capacity = 16'384;  ///< Samples.
  std::size_t log_capacity = 1'024;     ///< Commands.
};

/// What is wrong with `options`, a sentence to be shown to a person; empty if nothing is. *Pure.*
[[nodiscard]] G4LIDAR_API std::string_view problem_with(const device_options& options) noexcept;

}  // namespace g4lidar::sim
