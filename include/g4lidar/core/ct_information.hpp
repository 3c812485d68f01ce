// SPDX-License-Identifier: MIT
// The CT bytes of a revolution: the CRC-8 over them that some devices send before each zero packet, and how one-way
// lidars identify themselves by them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "g4lidar/core/model_record.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/stream_counts.hpp"
#include "g4lidar/settings.hpp"

namespace g4lidar {

namespace detail {

/// The CRC of each single byte.
inline constexpr auto crc_steps = [] {
  std::array<std::uint8_t, 256> made{};
  for (unsigned i = 0; i < made.size(); ++i) {
    unsigned value = i;
    for (int bit = 0; bit < 8; ++bit) value = value >> 1 ^ ((value & 1U) != 0 ? 0x8CU : 0U);
    made[i] = static_cast<std::uint8_t>(value);
  }
  return made;
}();

}  // namespace detail

/// `crc` continued over `byte`: CRC-8/MAXIM, polynomial 31h reflected, start 0. *Pure.*
/// (protocol: The stream, CRC byte)
[[nodiscard]] constexpr std::uint8_t next_crc(std::uint8_t crc, std::uint8_t byte) noexcept {
  return detail::crc_steps[crc ^ unsigned{byte}];
}

/// The CT bytes of the revolution that is being received: whether all of them were, and their CRC.
/// *Single thread, never allocates.*
class ct_revolution {
 public:
  /// Passes a packet, suspect or not. If a revolution ends with it that was received from zero packet
  /// to zero packet, with exactly one byte of noise before the last one and no other skipped byte:
  /// whether this byte is its CRC. What is known to be damaged proves nothing.
  constexpr std::optional<bool> add(packet_view packet) noexcept {
    std::optional<bool> fits;
    if (packet.is_zero()) {
      if (is_open_ && noise_ == 1) fits = byte_ == crc_;
      is_open_ = true;
      crc_ = 0;
    } else if (noise_ != 0) {
      is_open_ = false;
    }
    crc_ = next_crc(crc_, packet.ct());
    noise_ = 0;
    return fits;
  }
  /// Passes skipped bytes.
  constexpr void add(skipped gone) noexcept {
    if (gone.reason != skip_reason::noise) is_open_ = false;
    noise_ = std::min<std::size_t>(noise_ + gone.count, 2);
    byte_ = gone.last;
  }

 private:
  std::uint8_t crc_ = 0;
  std::uint8_t byte_ = 0;  // the last skipped one
  std::size_t noise_ = 0;  // bytes since the last packet, at most 2
  bool is_open_ = false;   // received from its zero packet on, without a skipped byte
};

/// Compares the byte before each zero packet with the CRC of the CT bytes of the revolution that
/// ends there. *Single thread, never allocates.*
///
/// What the byte means is not known at first: most devices send any byte there. When it has fitted
/// in three revolutions in a row, it is a check: from then on a byte that does not fit means that a
/// packet of its revolution was lost. A random byte fits in one of 256 revolutions, so a byte that
/// did not fit before has to fit as often in a row as it did not fit, up to 16 times. After three
/// revolutions in a row that do not fit it is unknown again.
///
/// (protocol: The stream, CRC byte)
class ct_check {
 public:
  /// The result for one packet.
  enum class result : std::uint8_t {
    none,      ///< No revolution ends with it, or there is nothing to compare.
    match,     ///< The byte is a check, and fits: no packet of the revolution was lost.
    mismatch,  ///< The byte is a check, and does not fit.
  };

  /// Passes a packet, suspect or not.
  constexpr void add(packet_view packet) noexcept {
    const std::optional<bool> fits = received_.add(packet);
    last_ = fits ? judge(*fits) : result::none;
  }
  /// Passes skipped bytes.
  constexpr void add(skipped gone) noexcept { received_.add(gone); }
  /// The result for the last packet.
  [[nodiscard]] constexpr result last() const noexcept { return last_; }
  /// Whether the byte is a check now.
  [[nodiscard]] constexpr bool is_trusted() const noexcept { return is_trusted_; }

 private:
  static constexpr std::uint8_t in_a_row = 3;
  static constexpr std::uint8_t most = 16;

  [[nodiscard]] constexpr result judge(bool fits) noexcept {
    const bool was_trusted = is_trusted_;
    if (is_trusted_) {
      misfits_ = fits ? std::uint8_t{0} : static_cast<std::uint8_t>(misfits_ + 1);
      fits_ = 0;
      is_trusted_ = misfits_ < in_a_row;
    } else if (fits) {
      fits_ = static_cast<std::uint8_t>(fits_ + 1);
      is_trusted_ = fits_ >= std::max(in_a_row, misfits_);
      if (is_trusted_) misfits_ = 0;
    } else {
      fits_ = 0;
      misfits_ = std::min(static_cast<std::uint8_t>(misfits_ + 1), most);
    }
    if (fits) return is_trusted_ ? result::match : result::none;
    return was_trusted ? result::mismatch : result::none;
  }

  ct_revolution received_;
  std::uint8_t fits_ = 0;     // in a row, before it is trusted
  std::uint8_t misfits_ = 0;  // in a row while it is trusted; before, all
  bool is_trusted_ = false;
  result last_ = result::none;
};

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
  /// Eight digits, beginning at place `first`.
  static constexpr void write_digits(unsigned number, std::array<char, 16>& digits,
                                     std::size_t first) noexcept {
    for (std::size_t i = first + 8; i-- > first; number /= 10) {
      digits[i] = static_cast<char>('0' + number % 10);
    }
  }

  ct_revolution received_;
  std::array<std::uint8_t, end> values_{};
  std::size_t count_ = 0;  // packets of the revolution
  unsigned fits_ = 0;      // CRC bytes in a row, up to in_a_row
  std::optional<ct_information> last_;
};

}  // namespace g4lidar
