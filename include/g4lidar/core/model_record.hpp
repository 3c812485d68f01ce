// SPDX-License-Identifier: MIT
// What the library knows about a model of lidar: a record. A difference between models is a field.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "g4lidar/detail/api.hpp"

namespace g4lidar {

/// How the bytes of a sample are read. All numbers are little-endian; r is the 16-bit word of the
/// range.
enum class sample_layout : std::uint8_t {
  quarter_mm,    ///< 2 bytes: r / 4 mm; no return if r / 4 is below 1.
  flagged_mm,    ///< 2 bytes: r >> 2 mm, and two flags.
  half_mm,       ///< 2 bytes: r / 2 mm.
  whole_mm,      ///< 2 bytes: r mm.
  intensity_10,  ///< 3 bytes: 8 bits of intensity, then r >> 2 mm and 2 upper bits of intensity.
  intensity_8,   ///< 3 bytes: 8 bits of intensity, then r >> 2 mm and two flags.
  intensity_16,  ///< 4 bytes: 16 bits of intensity, then r mm.
};

/// The size of a sample in bytes: 2, 3 or 4. *Pure.*
[[nodiscard]] constexpr std::size_t sample_size(sample_layout layout) noexcept {
  const std::size_t has_intensity = layout >= sample_layout::intensity_10 ? 1 : 0;
  return 2 + has_intensity + (layout == sample_layout::intensity_16 ? 1 : 0);
}

/// The bits of intensity of a sample: 0, 8, 10 or 16. *Pure.*
[[nodiscard]] constexpr int intensity_bits(sample_layout layout) noexcept {
  if (layout == sample_layout::intensity_16) return 16;
  if (layout == sample_layout::intensity_10) return 10;
  return layout == sample_layout::intensity_8 ? 8 : 0;
}

/// Whether a sample contains two flags. *Pure.*
[[nodiscard]] constexpr bool has_sample_flags(sample_layout layout) noexcept {
  return layout == sample_layout::flagged_mm || layout == sample_layout::intensity_8;
}

/// The second-level correction of an angle by the range.
enum class correction_kind : std::uint8_t {
  triangle,  ///< atan(21.8 (155.3 - d) / (155.3 d)), d in mm.
  scl,       ///< atan(17.8 / d), d in mm.
  none,
};

/// What a correction adds to the first-level angle of a sample without return, in degrees: its limit
/// for far targets, so that the angle is the direction in which the sensor looked. *Pure.*
[[nodiscard]] constexpr double no_return_correction_deg(correction_kind kind) noexcept {
  return kind == correction_kind::triangle ? -7.9905962679645856 : 0.0;  // atan(-21.8 / 155.3)
}

/// Whether a lidar answers commands, or sends from power-on and answers nothing.
enum class link_kind : std::uint8_t { two_way, one_way };

/// When a model is taken where bytes fit several.
enum class usual_kind : std::uint8_t {
  no,
  at_its_rate,    ///< Among those with its layout and its baud rate.
  of_its_layout,  ///< Also where the baud rate is not known.
};

/// What starts and stops the motor.
enum class motor_kind : std::uint8_t {
  command,  ///< The commands start and stop.
  dtr,      ///< The line DTR of the serial port.
  supply,   ///< It turns as long as there is power.
};

/// Whether a model has a feature, as far as it is known.
enum class presence : std::uint8_t { no, yes, unknown };

/// How the samples of a packet are read, and which replies there are.
struct sample_format {
  sample_layout layout = sample_layout::quarter_mm;
  correction_kind correction = correction_kind::triangle;
  std::uint8_t max_samples = 40;  ///< The largest LSN of a packet.
  /// Whether replies contain angles, too: to the commands 93 and 98.
  bool has_angle_replies = false;
  std::uint8_t largest_byte_reply = 2;  ///< The largest content of a reply of one byte.
};

/// A sample rate that a model can have.
struct sample_rate_entry {
  std::uint32_t hz = 0;  ///< 0 in an unused entry.
  /// The shortest range at this rate, in millimetres, by the manufacturer; 0: that of the model.
  std::uint16_t shortest_mm = 0;
};

/// How many codes of sample rates there are in replies to D1, of all models.
inline constexpr std::uint8_t all_rate_codes = 5;

/// The sample rates of a model.
struct sample_rate_list {
  /// All that are known, unused entries at the end. Where D0 sets the rate, the place of an entry is
  /// its code in the replies to D0 and D1.
  std::array<sample_rate_entry, 3> entries{};
  std::uint32_t nominal_hz = 0;  ///< Of a device as delivered; 0 if it is not known in advance.
  bool is_settable = false;      ///< Has the commands D0 and D1.
  /// The rates in Hz that further codes in replies to D1 mean, from the number of `entries` on, 3; 0: none.
  std::array<std::uint32_t, all_rate_codes - 3> further_codes_hz{};
  /// Owners have devices with other rates than by the manual: between these; 0: none is known.
  std::uint32_t least_seen_hz = 0;
  std::uint32_t most_seen_hz = 0;  ///< See `least_seen_hz`.
};

/// The scan frequency of a model.
struct frequency_properties {
  /// The limits of what commands can set, in 0.01 Hz; 0: not by command.
  std::uint16_t min_chz = 0;
  std::uint16_t max_chz = 0;          ///< See `min_chz`.
  std::int16_t reply_offset_chz = 0;  ///< To be added to what replies contain, in 0.01 Hz.
  std::int16_t ct_offset_chz = 0;     ///< To be added to what zero packets contain, in 0.01 Hz.
  /// Where no command sets it: the pin of the lidar at which a voltage or PWM does, "M_SCTR". Valid forever.
  std::string_view pin{};
};

/// The ranges of a model, in millimetres.
struct range_limits {
  std::uint16_t min_mm = 0;  ///< A return below this is too near to be reliable.
  std::uint16_t max_mm = 0;  ///< By the manufacturer; a sample can contain more.
};

/// How devices with old firmware differ from their model. See with_firmware().
struct firmware_difference {
  std::uint16_t last_version = 0;  ///< 256 * major + minor; 0 if there is no difference.
  sample_layout layout = sample_layout::quarter_mm;  ///< Of the same size.
  std::int16_t ct_offset_chz = 0;                    ///< As in frequency_properties.
  std::uint8_t zero_angle_divisor = 0;
};

/// A model of lidar.
struct model {
  std::string_view word;  ///< Its name in options and files: "x4-pro". Valid forever.
  std::string_view name;  ///< Its name for people: "X4 Pro". Valid forever.
  /// The numbers with which its devices identify themselves, 0: no other. Other models may use
  /// them, too.
  std::array<std::uint8_t, 2> ids{};
  std::array<std::uint32_t, 2> bauds{};  ///< Bits per second, the usual one first; 0: no other.
  sample_format samples{};
  link_kind link = link_kind::two_way;
  motor_kind motor = motor_kind::command;
  sample_rate_list rates{};
  frequency_properties frequency{};
  range_limits range{};
  /// The turn from the device's frame, mirrored, to the robot's, in degrees: 0 or 180. A direction
  /// in the robot's frame is this minus that in the device's.
  std::uint16_t turn_deg = 0;
  /// The reply to command 93 divided by this is the offset of zero in degrees; 0: no such command.
  std::uint8_t zero_angle_divisor = 0;
  presence protection = presence::unknown;      ///< Command D9, power-down protection.
  presence ct_information = presence::unknown;  ///< CT has information, and a CRC byte follows.
  /// Has the commands 01, 02 and 05 to 08, 0E and 0F: idle, direction, constant frequency.
  bool has_motor_settings = false;
  /// The layout of some of its devices; that of `samples` if there is no other.
  sample_layout other_layout = samples.layout;
  firmware_difference old_firmware{};
  bool has_pitch = false;             ///< Command 98.
  usual_kind usual = usual_kind::no;  ///< Whether it is taken where bytes fit several models.

  /// Whether its devices identify themselves with this number; not with 0.
  [[nodiscard]] constexpr bool has_number(std::uint8_t id) const noexcept {
    return id != 0 && (id == ids[0] || id == ids[1]);
  }
  /// Whether both are the same model, also of a device with other firmware (with_firmware()).
  friend constexpr bool operator==(const model& a, const model& b) noexcept {
    return a.word == b.word;
  }
};

/// Whether `model` measures the intensity of returns. *Pure.*
[[nodiscard]] constexpr bool has_intensity(const model& model) noexcept {
  return intensity_bits(model.samples.layout) > 0;
}

/// The highest sample rate of `model` in Hz. *Pure.*
[[nodiscard]] constexpr std::uint32_t highest_rate_hz(const model& model) noexcept {
  std::uint32_t highest = 0;
  for (const sample_rate_entry& rate : model.rates.entries) {
    if (rate.hz > highest) highest = rate.hz;
  }
  return highest;
}

/// The sample rate in Hz that `code` means in the replies to D0 and D1; 0 if it means none. *Pure.*
[[nodiscard]] constexpr std::uint32_t rate_hz_of_code(const model& model,
                                                      std::uint8_t code) noexcept {
  const sample_rate_list& rates = model.rates;
  if (code < rates.entries.size()) return rates.entries[code].hz;
  const std::size_t further = code - rates.entries.size();
  return further < rates.further_codes_hz.size() ? rates.further_codes_hz[further] : 0;
}

/// How many sample rates of `model` are known: 1 to 3. *Pure.*
[[nodiscard]] constexpr std::uint8_t rate_count(const model& model) noexcept {
  std::uint8_t count = 0;
  for (const sample_rate_entry& rate : model.rates.entries) {
    if (rate.hz != 0) ++count;
  }
  return count;
}

/// The code of a sample rate in the replies to D0 and D1; rate_count() if `model` does not have it. *Pure.*
[[nodiscard]] constexpr std::uint8_t code_of_rate(const model& model,
                                                  std::uint32_t rate_hz) noexcept {
  std::uint8_t code = 0;
  for (const sample_rate_entry& rate : model.rates.entries) {
    if (rate.hz == 0 || rate.hz == rate_hz) break;
    ++code;
  }
  return code;
}

/// The sample rate of `model` to begin with: the nominal one, or the highest if it is not known. *Pure.*
[[nodiscard]] constexpr std::uint32_t first_rate_hz(const model& model) noexcept {
  return model.rates.nominal_hz != 0 ? model.rates.nominal_hz : highest_rate_hz(model);
}

/// What is known of a sample rate before it is measured: the time from one sample to the next is
/// within `tolerance` of 1 / `hz`, as a fraction of it.
struct expected_rate {
  double hz = 0.0;
  double tolerance = 0.0;
};

/// Whether devices like `model` with this sample rate are known that do not have it by their manual. *Pure.* What was
/// measured is right within 2 %.
[[nodiscard]] constexpr bool is_seen_rate(const model& model, double hz) noexcept {
  return model.rates.least_seen_hz != 0 && 100.0 * hz >= 98.0 * model.rates.least_seen_hz &&
         100.0 * hz <= 102.0 * model.rates.most_seen_hz;
}

/// What is known of the sample rate of a device of the model `model`, which is `given_hz` by its reply,
/// by its model or by the user. A reply is true within 4 %. A device that cannot be asked may have
/// another firmware than the table: 10 %. Where the table has several rates and the device is not asked,
/// it is between the lowest and the highest of them, and 10 % beyond. Where owners have seen other rates, it is
/// between those, and 2 % beyond. *Pure.*
[[nodiscard]] constexpr expected_rate expected_rate_of(const model& model,
                                                       std::uint32_t given_hz) noexcept {
  const sample_rate_list& rates = model.rates;
  if (rates.is_settable) return {static_cast<double>(given_hz), 0.04};
  const bool is_seen = is_seen_rate(model, given_hz);
  if (rates.nominal_hz != 0 && !is_seen) return {static_cast<double>(given_hz), 0.1};
  const double beyond = is_seen ? 0.02 : 0.1;
  const double lowest_hz = is_seen ? rates.least_seen_hz : rates.entries[0].hz;  // they ascend
  const double highest_hz = is_seen ? rates.most_seen_hz : highest_rate_hz(model);
  const double shortest_s = 1.0 / ((1.0 + beyond) * highest_hz);
  const double longest_s = 1.0 / ((1.0 - beyond) * lowest_hz);
  return {2.0 / (longest_s + shortest_s), (longest_s - shortest_s) / (longest_s + shortest_s)};
}

/// The rotation frequency that a zero packet of a lidar like `model` means with `reported_chz`, both in
/// 0.01 Hz; 0, not reported, stays 0, and more than a packet can report, 12.7 Hz, counts as that. *Pure.*
template <class Number>
[[nodiscard]] constexpr Number true_frequency_chz(const model& model,
                                                  Number reported_chz) noexcept {
  constexpr Number most = 1270;
  if (!(reported_chz > 0)) return Number{};
  return (reported_chz < most ? reported_chz : most) + model.frequency.ct_offset_chz;
}

/// The most points of a revolution of `model`: four times those of its highest sample rate at its lowest
/// frequency, because a motor that spins up is slower; at least 8192. *Pure.*
[[nodiscard]] constexpr std::size_t largest_scan(const model& model) noexcept {
  constexpr std::uint32_t lowest_chz_without_command = 400;
  const std::uint32_t set_chz = model.frequency.min_chz;
  const std::uint32_t lowest_chz = set_chz != 0 ? set_chz : lowest_chz_without_command;
  const std::size_t most = std::size_t{4} * 100 * highest_rate_hz(model) / lowest_chz;
  return most < 8192 ? 8192 : most;
}

/// The unit in which a sample contains its range, as the number of them in a millimetre: 4, 2 or 1.
/// Lower bits that are no part of the range count as fractions of it. *Pure.*
[[nodiscard]] constexpr int range_units_per_mm(sample_layout layout) noexcept {
  if (layout == sample_layout::half_mm) return 2;
  return layout == sample_layout::whole_mm || layout == sample_layout::intensity_16 ? 1 : 4;
}

/// The longest range that a sample of this layout can contain, in millimetres. *Pure.*
[[nodiscard]] constexpr float longest_range_mm(sample_layout layout) noexcept {
  using enum sample_layout;
  constexpr float largest_word = 65535.0F;
  if (layout == quarter_mm) return largest_word / 4.0F;
  if (layout == half_mm) return largest_word / 2.0F;
  return layout == whole_mm || layout == intensity_16 ? largest_word : 16383.0F;
}

/// The shortest range of `model` at this sample rate in millimetres, by the manufacturer. *Pure.*
[[nodiscard]] constexpr std::uint16_t shortest_range_mm(const model& model,
                                                        std::uint32_t rate_hz) noexcept {
  for (const sample_rate_entry& rate : model.rates.entries) {
    if (rate.hz == rate_hz && rate.shortest_mm != 0) return rate.shortest_mm;
  }
  return model.range.min_mm;
}

}  // namespace g4lidar
