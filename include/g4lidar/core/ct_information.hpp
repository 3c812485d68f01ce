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

/// The contents of the CT bytes of a revolution.
struct ct_information {
  std::uint8_t customer;  ///< A version of the customer.
  ct_faults faults;
  std::uint8_t hardware;
  std::uint8_t firmware_major;
  std::uint8_t firmware_minor;
  /// The lower four bits of the number with which the model identifies itself.
  std::uint8_t id_low_bits;
  std::array<char, 16> serial_digits;  ///< As in device_information: the date, and a number.

  friend constexpr bool operator==(const ct_information&, const ct_information&) = default;
};

/// What a device of the model `which` would report with `stated`. CT has only the lower bits of the number
/// of the model. *Pure.*
[[nodiscard]] constexpr device_information information_of(const ct_information& stated,
                                                          const model& which) noexcept {
  std::uint8_t number = stated.id_low_bits;
  for (const std::uint8_t id : which.ids) {
    if ((id & 15U) == stated.id_low_bits) number = id;
  }
  return {number, stated.firmware_major, stated.firmware_minor, stated.hardware,
          stated.serial_digits};
}

/// Reads the information from the packets of a stream. *Single thread, never allocates.* A revolution
/// is believed only if the CRC byte behind it fits, and if it names a model and a possible date: other
/// models send zeros in the CT bytes, or another value in all of them, and a random byte behind them,
/// which fits in one of 256 revolutions.
class ct_information_reader {
 public:
  /// Passes a packet, suspect or not. Returns whether a revolution ended with it whose information is
  /// believed; then last() has it.
  constexpr bool add(packet_view packet) noexcept {
    const std::optional<bool> fits = received_.add(packet);
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

  /// The last information; nothing before there is one.
  [[nodiscard]] constexpr const std::optional<ct_information>& last() const noexcept {
    return last_;
  }

 private:
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

  constexpr bool read() noexcept {
    const unsigned id_bits = values_[id] & 15U;
    const unsigned years = values_[year] >> 2U;
    const unsigned months = values_[month] >> 3U;
    const unsigned days = values_[day] >> 2U;
    const bool is_date = months >= 1 && months <= 12 && days >= 1 && days <= 31;
    const bool is_constant = std::all_of(values_.begin() + 2, values_.end(),
                                         [this](unsigned each) { return each == values_[1]; });
    if (count_ < end || id_bits == 0 || !is_date || is_constant) return false;
    const unsigned number = (values_[year] & 3U) << 19U | (values_[month] & 7U) << 16U |
                            (values_[day] & 3U) << 14U | unsigned{values_[number_middle]} << 7U |
                            values_[number_low];
    ct_information found{
        .customer = values_[customer],
        .faults = static_cast<ct_faults>(values_[faults]),
        .hardware = static_cast<std::uint8_t>(values_[hardware_and_major] >> 4U),
        .firmware_major = static_cast<std::uint8_t>(values_[hardware_and_major] & 15U),
        .firmware_minor = values_[minor],
        .id_low_bits = static_cast<std::uint8_t>(id_bits),
        .serial_digits = {},
    };
    write_digits((2020 + years) * 10'000 + months * 100 + days, found.serial_digits, 0);
    write_digits(number, found.serial_digits, 8);
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
  std::optional<ct_information> last_;
};

}  // namespace g4lidar
