// SPDX-License-Identifier: MIT
// What a lidar reports about itself: model, firmware, serial number, health.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "g4lidar/detail/cpp20.hpp"

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

}  // namespace g4lidar
