// SPDX-License-Identifier: MIT
// The commands of the protocol on the device's side, written from the protocol page and not from
// the core.
#include "sim/exact.hpp"

#include "command_effects.hpp"

#include <algorithm>
#include <cstddef>

namespace g4lidar::sim {
namespace {

answer_bytes answer_with_byte(std::uint8_t byte) noexcept {
  return answer_with(response_kind::byte, std::array{byte});
}

constexpr std::uint8_t zero_angle_code = 0x93;
constexpr std::uint8_t pitch_code = 0x98;
constexpr std::uint8_t pitch_type = 0x10;

// The lowest byte first.
answer_bytes answer_with_number(std::int32_t number) noexcept {
  std::array<std::uint8_t, 4> content{};
  for (std::size_t i = 0; i < content.size(); ++i) {
    content[i] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(number) >> 8 * i & 0xFFU);
  }
  return answer_with(response_kind::frequency, content);
}

answer_bytes answer_with_frequency(std::uint16_t chz, const device_options& options) noexcept {
  return answer_with_number(std::max(chz + options.frequency_error_chz, 0));
}

// The nearest number of parts of a degree.
answer_bytes answer_with_zero_angle(const device_options& options) noexcept {
  const std::int64_t hundredths =
      std::int64_t{options.zero_angle_cdeg} * options.zero_angle_divisor;
  const std::int64_t half = hundredths < 0 ? -50 : 50;
  return answer_with_number(static_cast<std::int32_t>((hundredths + half) / 100));
}

answer_bytes answer_with_pitch(const device_options& options) noexcept {
  answer_bytes answer = answer_with_number(options.pitch_cdeg);
  answer.data[response_header_size - 1] = pitch_type;
  return answer;
}

// Sets the value, and answers with it.
template <class Setting>
answer_bytes set(Setting& stored, Setting wanted) noexcept {
  stored = wanted;
  return answer_with_byte(static_cast<std::uint8_t>(wanted));
}

answer_bytes step(std::uint16_t& frequency_chz, int by_chz,
                  const device_options& options) noexcept {
  const int least = options.scanner.format.min_frequency_chz;
  const int most = options.highest_frequency_chz;
  const int wanted = frequency_chz + by_chz;
  const bool possible = wanted >= least && wanted <= most;
  if (possible || options.frequency_at_limit == at_limit::clamp) {
    frequency_chz = static_cast<std::uint16_t>(std::clamp(wanted, least, most));
  }
  return answer_with_frequency(frequency_chz, options);
}

std::size_t code_of(sample_rate now, const wire_format& format) noexcept {
  const auto at = std::ranges::find(format.rates_hz, to_hz(now));
  return static_cast<std::size_t>(at - format.rates_hz.begin());
}

// The first one behind the last one.
sample_rate next_of(sample_rate now, const wire_format& format) noexcept {
  const std::size_t next = code_of(now, format) + 1;
  const bool is_there = next < format.rates_hz.size() && format.rates_hz[next] != 0;
  return static_cast<sample_rate>(format.rates_hz[is_there ? next : 0]);
}

answer_bytes answer_with_rate(sample_rate now, const device_options& options) noexcept {
  const wire_format& format = options.scanner.format;
  const std::size_t code = code_of(now, format);
  const bool is_other = options.other_rate_codes && code < format.other_rate_codes.size();
  return answer_with_byte(is_other ? format.other_rate_codes[code]
                                   : static_cast<std::uint8_t>(code));
}

power_down_protection other_than(power_down_protection now) noexcept {
  return now == power_down_protection::on ? power_down_protection::off : power_down_protection::on;
}

}  // namespace

answer_bytes answer_with(response_kind kind, bytes content) noexcept {
  answer_bytes answer;
  const response_layout& layout = response_layouts[static_cast<std::size_t>(kind)];
  std::copy(layout.header.begin(), layout.header.end(), answer.data.begin());
  std::copy(content.begin(), content.end(), answer.data.begin() + response_header_size);
  answer.size = static_cast<std::uint8_t>(response_header_size + content.size());
  return answer;
}

answer_bytes answer_with(const device_information& info) noexcept {
  std::array<std::uint8_t, max_response_content> content{info.model, info.firmware_minor,
                                                         info.firmware_major, info.hardware};
  for (std::size_t i = 0; i < info.serial_digits.size(); ++i) {
    content[4 + i] = static_cast<std::uint8_t>(info.serial_digits[i] - '0');
  }
  return answer_with(response_kind::device_info, content);
}

answer_bytes answer_with(const health& condition) noexcept {
  return answer_with(
      response_kind::health,
      std::array<std::uint8_t, 3>{static_cast<std::uint8_t>(condition.status),
                                  static_cast<std::uint8_t>(condition.error_code & 0xFFU),
                                  static_cast<std::uint8_t>(condition.error_code >> 8)});
}

device_settings first_settings(const device_options& options) noexcept {
  device_settings settings = options.initial;
  settings.scan_frequency_chz = options.scanner.scan_frequency_chz;
  settings.sample_rate = options.scanner.sample_rate;
  return settings;
}

std::optional<answer_bytes> apply(command code, device_settings& now,
                                  const device_options& options) noexcept {
  const auto number = static_cast<std::uint8_t>(code);
  if (number == zero_angle_code) return answer_with_zero_angle(options);
  if (number == pitch_code) return answer_with_pitch(options);
  switch (code) {
    case command::low_power_on:
      return set(now.idle_power, low_power::on);
    case command::low_power_off:
      return set(now.idle_power, low_power::off);
    case command::low_power_query:
      return set(now.idle_power, now.idle_power);
    case command::motor_clockwise:
      return set(now.direction, motor_direction::clockwise);
    case command::motor_counter_clockwise:
      return set(now.direction, motor_direction::counter_clockwise);
    case command::motor_direction_query:
      if (!options.answers_direction) return std::nullopt;
      return set(now.direction, now.direction);
    case command::frequency_up_0_1_hz:
      return step(now.scan_frequency_chz, 10, options);
    case command::frequency_down_0_1_hz:
      return step(now.scan_frequency_chz, -10, options);
    case command::frequency_up_1_hz:
      return step(now.scan_frequency_chz, 100, options);
    case command::frequency_down_1_hz:
      return step(now.scan_frequency_chz, -100, options);
    case command::frequency_query:
      return answer_with_frequency(now.scan_frequency_chz, options);
    case command::constant_frequency_on:
      return set(now.constancy, constant_frequency::on);
    case command::constant_frequency_off:
      return set(now.constancy, constant_frequency::off);
    case command::sample_rate_next:
      now.sample_rate = next_of(now.sample_rate, options.scanner.format);
      return answer_with_rate(now.sample_rate, options);
    case command::sample_rate_query:
      if (!options.answers_sample_rate) return std::nullopt;
      return answer_with_rate(now.sample_rate, options);
    case command::protection_toggle:
      return set(now.protection, other_than(now.protection));
    default:
      return std::nullopt;
  }
}

}  // namespace g4lidar::sim
