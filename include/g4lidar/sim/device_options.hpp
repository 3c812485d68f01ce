// SPDX-License-Identifier: MIT
// The properties of a simulated lidar: its stored settings, and the choice for each open question.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string_view>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/settings.hpp"
#include "g4lidar/sim/scanner.hpp"

namespace g4lidar::sim {

/// Commands by their second byte. A device does not answer what it does not have. *Single thread.*
class command_set {
 public:
  /// Those of `codes`.
  constexpr command_set(std::initializer_list<std::uint8_t> codes) noexcept {
    for (const std::uint8_t code : codes) add(code);
  }

  /// Whether it contains the command.
  [[nodiscard]] constexpr bool has(std::uint8_t code) const noexcept {
    return (words_[code / 64U] >> code % 64U & 1U) != 0;
  }
  /// Adds a command.
  constexpr void add(std::uint8_t code) noexcept {
    words_[code / 64U] |= std::uint64_t{1} << code % 64U;
  }
  /// Adds all of `others`.
  constexpr void add(const command_set& others) noexcept {
    for (std::size_t i = 0; i < words_.size(); ++i) words_[i] |= others.words_[i];
  }

  friend constexpr bool operator==(const command_set&, const command_set&) = default;

 private:
  std::array<std::uint64_t, 4> words_{};
};

/// Those of every model that answers: stop, start, restart, information, health.
inline constexpr command_set basic_commands{0x00, 0x40, 0x60, 0x65, 0x80, 0x90, 0x91, 0x92};
/// The scan frequency.
inline constexpr command_set frequency_commands{0x09, 0x0A, 0x0B, 0x0C, 0x0D};
/// All those of a G4.
inline constexpr command_set g4_commands = [] {
  command_set all{0x01, 0x02, 0x05, 0x06, 0x07, 0x08, 0x0E, 0x0F, 0xD0, 0xD1, 0xD9};
  all.add(basic_commands);
  all.add(frequency_commands);
  return all;
}();

/// The settings that commands change, as stored in the device. The defaults are those of a G4.
struct device_settings {
  low_power idle_power = low_power::on;
  motor_direction direction = motor_direction::clockwise;
  std::uint16_t scan_frequency_chz = 700;
  constant_frequency constancy = constant_frequency::on;
  g4lidar::sample_rate sample_rate = g4lidar::sample_rate::khz_9;
  power_down_protection protection = power_down_protection::off;

  friend bool operator==(const device_settings&, const device_settings&) = default;
};

/// The effect of a step of the scan frequency beyond 5 or 12 Hz.
enum class at_limit : std::uint8_t {
  clamp,   ///< The frequency becomes the limit.
  refuse,  ///< The frequency does not change.
};

/// The effect of a command that must not be sent while scanning.
enum class disturbance : std::uint8_t {
  mid_packet,  ///< It is answered in the middle of a packet.
  between,     ///< It is answered between two packets.
  drops,       ///< Like mid_packet, and the rest of that packet is lost.
  ignored,     ///< No answer, and it is not executed.
};

/// What makes the motor turn.
enum class drive : std::uint8_t {
  commands,  ///< Start and stop.
  dtr_line,  ///< The line DTR of the host's port.
  power,     ///< It turns as long as the device has power.
};

/// What the line DTR of the host's port has to do so that a motor turns that it drives. Low stops it.
enum class dtr_start : std::uint8_t {
  level,  ///< It is high, as when a program opens the port.
  edge,   ///< It rises, also when a program opens the port.
  pulse,  ///< It rises while a program has the port open.
};

/// What a low DTR takes from a device that it drives.
enum class dtr_cut : std::uint8_t { motor, supply };

/// All properties of a device that are not faults. By default a healthy G4, as far as it is known;
/// use_model() makes it another model.
struct device_options {
  /// Measurement options, and the seed of everything random here. Its scan frequency and sample rate
  /// are the defaults of the device; `start_deg` is not used: each start has a random angle.
  scanner_options scanner;
  std::string_view model = "g4";       ///< The last one of use_model(); of unlimited lifetime.
  command_set commands = g4_commands;  ///< It does not answer others.
  /// The answer to 90.
  device_information info{
      model_g4,
      3,
      2,
      3,
      {'2', '0', '2', '1', '1', '0', '1', '0', '0', '0', '0', '7', '0', '0', '7', '3'}};
  health condition{health_status::ok, 0};

  /// It sends from power-on, answers nothing, and ignores what is sent to it.
  bool one_way = false;
  /// A motor that is not driven by commands turns whether it scans or not. While it does not turn, the
  /// device answers, but sends no packets.
  drive driven_by = drive::commands;
  dtr_start dtr_starts_by =
      dtr_start::pulse;               ///< Only if DTR drives it, and the connection has this line.
  dtr_cut dtr_cuts = dtr_cut::motor;  ///< The same.
  std::int64_t dtr_low_ns = 50'000'000;  ///< DTR must be low for so long before it rises.
  bool motor_has_power = true;           ///< False: the second plug of an X4 is not connected.

  // The connection.
  std::uint32_t baud = 230'400;
  bool any_baud = false;  ///< Bytes arrive whatever rate the host has set.
  /// How long bytes wait in the USB bridge, random for each batch. A fault `batch` overrides it.
  std::int64_t batch_min_ns = 0;
  std::int64_t batch_max_ns = 1'000'000;
  std::int64_t reaction_ns =
      1'000'000;                     ///< From the last byte of a command to its effect and answer.
  std::int64_t first_answer_ns = 0;  ///< Additional delay of the first answer after a boot.

  // The start of a scan: the motor turns from the command on.
  std::int64_t header_ns = 0;  ///< From the effect of the command to the scan header.
  std::int64_t silence_ns =
      0;  ///< From the header to the first packet; earlier measurements are not sent.
  std::int64_t stop_ns = 0;  ///< From a stop to the last packet; 0 if none was sent yet.

  // The motor.
  std::uint32_t acceleration_mhz_per_s = 14'000;  ///< Of the scan frequency; 7 Hz in half a second.
  std::int64_t standstill_ns = 60'000'000;        ///< Until the motor begins to move.
  /// The deviation of the speed to either side, in millionths, with and without constant frequency,
  /// and the period of the deviation.
  std::uint32_t motor_drift_ppm = 2'000;
  std::uint32_t free_motor_drift_ppm = 30'000;
  std::int64_t motor_drift_period_ns = 20'000'000'000;
  /// The effect of counter-clockwise rotation on the angles.
  turning counter_clockwise = turning::mirrored;

  // What healthy devices send in addition to the protocol.
  bool stray_after_start = true;  ///< A 00 after the scan header.
  bool stray_before_zero = true;  ///< A random byte before every zero packet.
  bool ct_crc =
      false;  ///< That byte is the CRC of the revolution, as newer devices of the family send it.
  /// CT of the packets behind a zero packet has health, versions and numbers, as with one-way models.
  bool ct_information = false;
  std::int64_t time_packet_ns = 0;  ///< The interval of time packets; 0: none, as a G4.
  bool empty_packets =
      false;  ///< A packet without samples before every zero packet, as of some X2.
  bool stop_truncates = true;    ///< A stop truncates the packet that is being sent.
  bool boot_text = true;         ///< ASCII after a restart and after power-on.
  bool boot_information = true;  ///< Then the device information, without a query.
  std::int64_t boot_ns = 400'000'000;

  // Open questions of the protocol.
  at_limit frequency_at_limit = at_limit::clamp;
  std::uint16_t highest_frequency_chz = 1200;  ///< The highest possible frequency.
  disturbance while_scanning = disturbance::mid_packet;
  bool settings_outlive_power = false;
  bool settings_outlive_restart = false;
  bool answers_direction = true;    ///< To command 08.
  bool answers_sample_rate = true;  ///< To command D1.
  bool other_rate_codes = false;    ///< With the other codes of the format: a TG with 3 and 4.
  bool answers_health_91 = true;
  bool answers_health_92 = true;
  bool obeys_forced_stop = true;  ///< Command 00.
  bool obeys_restart_80 = true;
  bool obeys_restart_40 = true;
  bool error_refuses_start = false;  ///< With a health error, 60 is not answered.
  bool start_again_answers = false;  ///< 60 during a scan is answered with another header.
  bool header_after_protection =
      true;  ///< 60 is answered with a header after a stop by the protection.

  // What answers contain.
  std::int16_t frequency_error_chz = 0;  ///< What frequencies are too high: 40 of a TG.
  /// The direction of zero, in 0.01 degrees, as 93 answers it in parts of a degree: 4 or 100 in one, 0: no
  /// such answer. The angles that the device sends are smaller by it.
  std::int32_t zero_angle_cdeg = 0;
  std::uint8_t zero_angle_divisor = 0;
  std::int32_t pitch_cdeg = 0;  ///< The answer to 98, where it is.

  // The state at time 0: powered, idle, and booted long before.
  device_settings initial;      ///< Except the two frequencies, which are in `scanner`.
  bool boots_at_start = false;  ///< It is powered on at time 0.

  // Capacities; the oldest entries beyond them are lost.
  std::size_t truth_capacity = 16'384;  ///< Samples.
  std::size_t log_capacity = 1'024;     ///< Commands.
};

/// What is wrong with `options`, a sentence for people; empty if nothing is. *Pure.*
[[nodiscard]] G4LIDAR_API std::string_view problem_with(const device_options& options) noexcept;

/// Sets all in which a model of the family differs from a G4: what it sends, its rates, its ranges, its
/// commands, its motor, its numbers in the answer to 90. `word` is its name, such as "x4-pro"; `other_layout`
/// selects the other samples of the S2 and S2 Pro. A firmware in `options.info` that is not the usual one of
/// `options.model` is kept. If it is one before a change of the samples, as of a TG15 up to 1.2, they are the
/// old ones. Returns false, and changes nothing, if there is no such model, or no other layout.
[[nodiscard]] G4LIDAR_API bool use_model(device_options& options, std::string_view word,
                                         bool other_layout = false) noexcept;

/// The names of the models, in the order of the table. Valid forever. *Pure.*
[[nodiscard]] G4LIDAR_API std::span<const std::string_view> model_words() noexcept;

/// The options of the scanner of a device, with what its CT bytes contain, for a scanner without a device. *Pure.*
[[nodiscard]] G4LIDAR_API scanner_options scanner_of(const device_options& options) noexcept;

}  // namespace g4lidar::sim
