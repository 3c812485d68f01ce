// SPDX-License-Identifier: MIT
// From a row of the table to the options of a device.
#include "sim/exact.hpp"

#include "models.hpp"

#include <algorithm>
#include <cstddef>

#include "g4lidar/core/label.hpp"
#include "g4lidar/sim/device_options.hpp"

namespace g4lidar::sim {
namespace {

const simulated_model* find_model(std::string_view word) noexcept {
  const auto* const found = std::ranges::find_if(
      simulated_models,
      [word](const simulated_model& each) { return is_label_of(word, each.word); });
  return found == simulated_models.end() ? nullptr : found;
}

// The usual rate, or the fastest one that the connection carries: 10 bits a byte, and a quarter of a
// byte of each sample for the beginning of its packet.
std::size_t first_rate(const simulated_model& simulated, const sample_code& code) noexcept {
  const std::size_t quarters = 4 * code.size() + 1;
  std::size_t best = 0;
  for (std::size_t i = 0; i < simulated.rates.rows.size(); ++i) {
    const std::uint32_t hz = simulated.rates.rows[i].hz;
    if (hz == 0) break;
    if (hz == simulated.rates.usual_hz) return i;
    if (hz * quarters * 10 / 4 <= simulated.bauds[0]) best = i;
  }
  return best;
}

// 7 Hz, or 10 Hz if the model has no less than 6 Hz and can be set to it.
std::uint16_t first_frequency_chz(const simulated_model& of) noexcept {
  return of.frequency.is_stepped && of.frequency.slowest_chz >= 600 ? 1000 : 700;
}

command_set commands_of(const simulated_model& of) noexcept {
  const command_row& its = of.commands;
  command_set all = basic_commands;
  if (of.frequency.is_stepped) all.add(frequency_commands);
  if (its.idle) all.add({0x01, 0x02});
  if (its.idle_query) all.add(0x05);
  if (its.motor) all.add({0x06, 0x07, 0x08, 0x0E, 0x0F});
  if (of.rates.are_stepped) all.add({0xD0, 0xD1});
  if (its.rate_query_only) all.add(0xD1);
  if (its.protection == knowledge::present) all.add(0xD9);
  if (its.zero_divisor != 0) all.add(0x93);
  if (its.pitch) all.add(0x98);
  return all;
}

bool has_version(const device_information& info, const simulated_model* simulated) noexcept {
  return simulated != nullptr && info.firmware_major == simulated->version.major &&
         info.firmware_minor == simulated->version.minor &&
         info.hardware == simulated->version.hardware;
}

unsigned digits(const device_information& info, std::size_t from, std::size_t count) noexcept {
  unsigned number = 0;
  for (const char digit : std::span(info.serial_digits).subspan(from, count)) {
    number = 10 * number + static_cast<unsigned>(digit - '0');
  }
  return number;
}

// The serial number is a date, YYYYMMDD, and a number of at most 21 bits.
std::array<std::uint8_t, 16> ct_information(const device_information& info,
                                            const health& condition) noexcept {
  const bool is_ok = condition.status == health_status::ok;
  const unsigned wrong = is_ok ? 0U : std::max<unsigned>(condition.error_code, 1U);
  const unsigned number = digits(info, 8, 8);
  std::array<unsigned, 16> sevens{};  // of packet k in place k - 1
  sevens[2] = wrong & 0x3FU;
  sevens[3] = unsigned{info.hardware} << 4U | (info.firmware_major & 15U);
  sevens[4] = info.firmware_minor;
  sevens[6] = info.model & 15U;
  sevens[8] = (digits(info, 0, 4) - 2020) << 2U | (number >> 19 & 3U);
  sevens[9] = digits(info, 4, 2) << 3U | (number >> 16 & 7U);
  sevens[10] = digits(info, 6, 2) << 2U | (number >> 14 & 3U);
  sevens[11] = number >> 7;
  sevens[12] = number;
  std::array<std::uint8_t, 16> made{};
  for (std::size_t i = 0; i < made.size(); ++i) {
    made[i] = static_cast<std::uint8_t>((sevens[i] & 0x7FU) << 1U);
  }
  return made;
}

}  // namespace

bool use_model(device_options& options, std::string_view word, bool other_layout) noexcept {
  const simulated_model* const found = find_model(word);
  if (found == nullptr || (other_layout && !found->other_code)) return false;
  const simulated_model& of = *found;
  if (has_version(options.info, find_model(options.model))) {
    options.info.firmware_major = of.version.major;
    options.info.firmware_minor = of.version.minor;
    options.info.hardware = of.version.hardware;
  }
  const unsigned version = options.info.firmware_major * 256U + options.info.firmware_minor;
  const bool is_old = of.old.last != 0 && version <= of.old.last;

  scanner_options& scanner = options.scanner;
  wire_format& format = scanner.format;
  format.code = other_layout ? *of.other_code : is_old ? of.old.code : of.code;
  format.beam = of.beam;
  for (std::size_t i = 0; i < format.rates_hz.size(); ++i) {
    format.rates_hz[i] = of.rates.rows[i].hz;
    format.other_rate_codes[i] = of.rates.other_codes[i];
  }
  format.min_frequency_chz = of.frequency.slowest_chz;
  format.max_frequency_chz = of.frequency.fastest_chz;
  format.max_samples = of.max_samples;
  format.ct_offset_chz = is_old ? of.old.ct_offset_chz : of.frequency.ct_offset_chz;
  format.usual_flags = of.usual_flags;
  format.is_turned = of.is_turned;

  const std::size_t rate = first_rate(of, format.code);
  scanner.sample_rate = static_cast<sample_rate>(of.rates.rows[rate].hz);
  scanner.scan_frequency_chz = first_frequency_chz(of);
  scanner.index_deg = of.index_deg;
  scanner.reports_frequency = of.frequency.is_reported;
  const std::uint16_t nearest_mm = of.rates.rows[rate].nearest_mm;
  scanner.min_range_mm = nearest_mm != 0 ? nearest_mm : of.range.nearest_mm;
  scanner.max_range_mm = of.range.farthest_mm;

  options.model = of.word;
  options.commands = commands_of(of);
  options.answers_sample_rate = of.rates.are_stepped;
  options.frequency_error_chz = static_cast<std::int16_t>(-of.frequency.answer_offset_chz);
  options.zero_angle_divisor = is_old ? of.old.zero_divisor : of.commands.zero_divisor;
  options.info.model = of.ids[0];
  options.baud = of.bauds[0];
  options.one_way = of.answers == talk::never;
  options.while_scanning =
      of.answers == talk::always ? disturbance::mid_packet : disturbance::ignored;
  options.boot_text = !options.one_way || of.information == knowledge::present;
  options.driven_by = of.driven_by;
  options.dtr_starts_by = !options.one_way ? dtr_start::pulse : dtr_start::level;
  options.highest_frequency_chz = format.max_frequency_chz;
  options.stray_after_start = of.leading == leading_byte::random;
  options.stray_before_zero = of.leading != leading_byte::nothing;
  options.ct_crc = of.leading == leading_byte::crc;
  options.ct_information = of.information == knowledge::present;
  return true;
}

std::span<const std::string_view> model_words() noexcept {
  static constexpr auto words = [] {
    std::array<std::string_view, simulated_models.size()> all;
    std::ranges::transform(simulated_models, all.begin(), &simulated_model::word);
    return all;
  }();
  return words;
}

scanner_options scanner_of(const device_options& options) noexcept {
  scanner_options scanner = options.scanner;
  scanner.zero_deg = options.zero_angle_cdeg / 100.0;
  if (options.ct_information) {
    scanner.information = ct_information(options.info, options.condition);
  }
  return scanner;
}

}  // namespace g4lidar::sim
