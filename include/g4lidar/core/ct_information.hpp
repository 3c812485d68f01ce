// SPDX-License-Identifier: MIT
// How one-way lidars identify themselves: by the CT bytes of a revolution.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "g4lidar/core/ct_check.hpp"
#include "g4lidar/core/model_record.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/skipped.hpp"
#include "g4lidar/device_information.hpp"

namespace g4lidar {

/// What a lidar reports to be out of order; a set of bits.
enum class ct_faults : std::uint8_t {
  none = 0,
  sensor = 1,
  encoder = 2,
  wireless_supply = 4,  ///< The supply of the turning part.
  photodiode = 8,
  laser = 16,
  data = 32,
};

/// What the CT bytes of the revolutions state: each field by itself, because a revolution with few packets
/// has only the first ones. A field that was not stated is 0.
struct ct_information {
  bool has_faults;        ///< Whether `faults` was stated.
  bool has_firmware;      ///< Whether hardware and firmware were stated.
  bool has_serial;        ///< Whether the date and the number were stated.
  std::uint8_t customer;  ///< A version of the customer.
  ct_faults faults;
  std::uint8_t hardware;
  std::uint8_t firmware_major;
  std::uint8_t firmware_minor;
  /// The lower four bits of the number with which the model identifies itself; 0: not stated.
  std::uint8_t id_low_bits;
  std::array<char, 16> serial_digits;  ///< As in device_information: the date, and a number.

  friend constexpr bool operator==(const ct_information&, const ct_information&) = default;
};

/// What a device of the model `model` would report with `stated`. CT has only the lower bits of the number
/// of the model. Not known, device_information::is_known(), if these were not stated. *Pure.*
[[nodiscard]] constexpr device_information information_of(const ct_information& stated,
                                                          const model& model) noexcept {
  std::uint8_t number = stated.id_low_bits;
  for (const std::uint8_t id : model.ids) {
    if (stated.id_low_bits != 0 && (id & 15U) == stated.id_low_bits) number = id;
  }
  device_information made{number, stated.firmware_major, stated.firmware_minor, stated.hardware,
                          stated.serial_digits};
  if (!stated.has_serial) made.serial_digits.fill('0');
  return made;
}

/// Reads the information from the packets of a stream. *Single thread, never allocates.* A revolution
/// is believed only if the CRC byte behind it fits: at once if it names a model and a possible date, else if
/// that of the two revolutions before it fitted, too. Other models send zeros in the CT bytes, or another value
/// in all of them, and a random byte behind them, which fits in one of 256 revolutions.
class ct_information_reader {
 public:
  /// Passes a packet, suspect or not. Returns whether a revolution ended with it of which a field is
  /// believed; then last() has it.
  constexpr bool add(packet_view packet) noexcept {
    const std::optional<bool> fits = received_.add(packet);
    if (fits) fits_ = *fits ? std::min(fits_ + 1U, in_a_row) : 0U;
    const bool is_found = fits.value_or(false) && read();
    if (packet.is_zero()) {
      values_ = {};
      count_ = 0;
    }
    if (count_ < values_.size()) values_[count_] = static_cast<std::uint8_t>(packet.ct() >> 1);
    ++count_;
    return is_found;
  }
  /// Passes skipped bytes.
  constexpr void add(skipped gone) noexcept { received_.add(gone); }

  /// All fields that were believed, each as it was stated last; nothing before there is one.
  [[nodiscard]] constexpr const std::optional<ct_information>& last() const noexcept {
    return last_;
  }

 private:
  static constexpr unsigned in_a_row = 3;

  /// The bits of a CT byte above its lowest one, by the number of the packet in the revolution.
  enum place : std::uint8_t {
    customer = 1,
    faults = 3,
    hardware_and_major = 4,
    minor = 5,
    id = 7,
    year = 9,  // since 2020, and bits 19 and 20 of the number
    month = 10,
    day = 11,
    number_middle = 12,
    number_low = 13,
    end = 14
  };

  /// Whether the revolution had a packet at this place.
  [[nodiscard]] constexpr bool has(place at) const noexcept { return count_ > at; }
  [[nodiscard]] constexpr bool is_constant() const noexcept {
    const auto* const behind = values_.begin() + std::min<std::size_t>(count_, end);
    return std::all_of(values_.begin() + 1, behind,
                       [this](unsigned each) { return each == values_[1]; });
  }
  [[nodiscard]] constexpr bool has_date() const noexcept {
    const unsigned months = values_[month] >> 3U;
    const unsigned days = values_[day] >> 2U;
    return has(day) && months >= 1 && months <= 12 && days >= 1 && days <= 31;
  }

  constexpr bool read() noexcept {
    constexpr unsigned all_faults = 63;
    const auto id_bits = static_cast<std::uint8_t>(values_[id] & 15U);
    if (!has(faults) || is_constant()) return false;
    if (fits_ < in_a_row && (id_bits == 0 || !has_date())) return false;
    ct_information found = last_.value_or(ct_information{});
    found.customer = values_[customer];
    if (values_[faults] <= all_faults) {
      found.has_faults = true;
      found.faults = static_cast<ct_faults>(values_[faults]);
    }
    if (has(minor) && (values_[hardware_and_major] != 0 || values_[minor] != 0)) {
      found.has_firmware = true;
      found.hardware = static_cast<std::uint8_t>(values_[hardware_and_major] >> 4U);
      found.firmware_major = static_cast<std::uint8_t>(values_[hardware_and_major] & 15U);
      found.firmware_minor = values_[minor];
    }
    if (has(id) && id_bits != 0) found.id_low_bits = id_bits;
    if (has(number_low) && has_date()) {
      found.has_serial = true;
      const unsigned date = (2020U + (values_[year] >> 2U)) * 10'000 +
                            (values_[month] >> 3U) * 100U + (values_[day] >> 2U);
      const unsigned number = (values_[year] & 3U) << 19U | (values_[month] & 7U) << 16U |
                              (values_[day] & 3U) << 14U | unsigned{values_[number_middle]} << 7U |
                              values_[number_low];
      write_digits(date, found.serial_digits, 0);
      write_digits(number, found.serial_digits, 8);
    }
    last_ = found;
    return true;
  }
  /// Eight digits from place `from` on.
  static constexpr void write_digits(unsigned number, std::array<char, 16>& to,
                                     std::size_t from) noexcept {
    for (std::size_t i = from + 8; i-- > from; number /= 10) {
      to[i] = static_cast<char>('0' + number % 10);
    }
  }

  ct_revolution received_;
  std::array<std::uint8_t, end> values_{};
  std::size_t count_ = 0;  // packets of the revolution
  unsigned fits_ = 0;      // CRC bytes in a row, up to in_a_row
  std::optional<ct_information> last_;
};

}  // namespace g4lidar
