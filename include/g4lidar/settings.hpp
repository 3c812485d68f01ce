// SPDX-License-Identifier: MIT
// What a lidar states of itself: who it is, and how it is set.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "g4lidar/detail/api.hpp"

namespace g4lidar {

/// What identifies a lidar. (protocol: Commands, device information)
struct device_information {
  std::uint8_t model;           ///< 5 is a G4.
  std::uint8_t firmware_major;  ///< The third byte on the wire.
  std::uint8_t firmware_minor;  ///< The second byte on the wire.
  std::uint8_t hardware;
  std::array<char, 16> serial_digits;  ///< '0' to '9'; not terminated.

  /// Whether it was ever reported: one-way lidars that do not send it have zeros in all members. *Pure.*
  [[nodiscard]] constexpr bool is_known() const noexcept { return model != 0; }
  /// Whether it has a serial number: the CT bytes of a one-way lidar have room for it only in revolutions of 14
  /// packets or more. Without one all digits are '0'. *Pure.*
  [[nodiscard]] constexpr bool has_serial_number() const noexcept {
    for (const char each : serial_digits) {
      if (each != '0' && each != '\0') return true;
    }
    return false;
  }
  /// The serial number; valid as long as this structure.
  [[nodiscard]] constexpr std::string_view serial_number() const& noexcept {
    return {serial_digits.data(), serial_digits.size()};
  }
  /// Deleted: the result would point into a destroyed structure.
  std::string_view serial_number() const&& = delete;

  friend constexpr bool operator==(const device_information&, const device_information&) = default;
};

/// The model number of a G4.
inline constexpr std::uint8_t model_g4 = 5;

/// The status that the device reports.
enum class health_status : std::uint8_t { ok = 0, warning = 1, error = 2 };

/// The name in tools and documents: "ok", "warning", "error". Valid forever. *Pure.*
[[nodiscard]] constexpr std::string_view name_of(health_status status) noexcept {
  return status == health_status::ok        ? "ok"
         : status == health_status::warning ? "warning"
                                            : "error";
}

/// The health that the device reports. The meaning of the bits of `error_code` is not known.
struct health {
  health_status status;
  std::uint16_t error_code;

  friend constexpr bool operator==(const health&, const health&) = default;
};

/// The rotation frequency of the head in 0.01 Hz, the unit of the protocol.
struct scan_frequency {
  std::uint16_t chz;

  /// `scan_frequency::hz(7.5)`: the nearest multiple of 0.01 Hz, limited to 16 bits. The limits of
  /// the model are checked where the value is used. *Pure.*
  [[nodiscard]] static constexpr scan_frequency hz(double value) noexcept {
    const double scaled = value * 100.0 + 0.5;
    if (!(scaled > 0.0)) return {0};  // also not-a-number
    return {scaled < 65535.0 ? static_cast<std::uint16_t>(scaled) : std::uint16_t{65535}};
  }
  /// In Hz. *Pure.*
  [[nodiscard]] constexpr double hz() const noexcept { return chz / 100.0; }

  friend constexpr bool operator==(scan_frequency, scan_frequency) noexcept = default;
};

/// The direction in which the head turns, seen from above. (commands 06, 07, 08)
enum class motor_direction : std::uint8_t { clockwise = 0, counter_clockwise = 1 };
/// The measurements per second, of which a G4 has these three. Other models have other values:
/// `sample_rate{18000}`. (commands D0, D1)
enum class sample_rate : std::uint16_t { khz_4 = 4000, khz_8 = 8000, khz_9 = 9000 };
/// Whether the lidar stops scanning by itself 3 s after the last command. (command D9)
enum class power_down_protection : std::uint8_t { on = 0, off = 1 };
/// Whether the motor stops while no scan is running. (commands 01, 02, 05)
enum class low_power : std::uint8_t { off = 0, on = 1 };
/// Whether the lidar regulates its scan frequency. (commands 0E, 0F)
enum class constant_frequency : std::uint8_t { off = 0, on = 1 };

/// What is to be added to each angle of a device so that zero is at the mark of its housing, in 0.01 degrees.
/// (command 93)
struct zero_angle {
  std::int32_t cdeg;
  /// In degrees. *Pure.*
  [[nodiscard]] constexpr double deg() const noexcept { return cdeg / 100.0; }
  /// Whether it was measured: devices that were not calibrated report 180 degrees, which is added all the same.
  /// *Pure.*
  [[nodiscard]] constexpr bool is_calibrated() const noexcept {
    return cdeg != 18'000 && cdeg != -18'000;
  }

  friend constexpr bool operator==(zero_angle, zero_angle) noexcept = default;
};

/// The tilt of the beam in 0.01 degrees. (command 98)
struct pitch_angle {
  std::int32_t cdeg;
  /// In degrees. *Pure.*
  [[nodiscard]] constexpr double deg() const noexcept { return cdeg / 100.0; }

  friend constexpr bool operator==(pitch_angle, pitch_angle) noexcept = default;
};

/// Whether `wanted`, of a setting with two values, is an enumerator: it may be a number that was cast. *Pure.*
template <class Setting>
[[nodiscard]] constexpr bool is_valid(Setting wanted) noexcept {
  return static_cast<std::uint8_t>(wanted) <= 1;
}

/// The measurements per second. *Pure.*
[[nodiscard]] constexpr std::uint32_t to_hz(sample_rate frequency) noexcept {
  return static_cast<std::uint32_t>(frequency);
}

}  // namespace g4lidar
