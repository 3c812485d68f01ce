// SPDX-License-Identifier: MIT
#include "protocol_log.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include "g4lidar/core/command.hpp"
#include "g4lidar/error.hpp"
#include "value_text.hpp"

namespace g4_tool {
namespace {

constexpr std::array<std::pair<command, std::string_view>, 24> command_words{{
    {command::forced_stop, "forced stop"},
    {command::low_power_on, "low power on"},
    {command::low_power_off, "low power off"},
    {command::low_power_query, "low power?"},
    {command::motor_clockwise, "clockwise"},
    {command::motor_counter_clockwise, "counter-clockwise"},
    {command::motor_direction_query, "direction?"},
    {command::frequency_up_0_1_hz, "0.1 Hz up"},
    {command::frequency_down_0_1_hz, "0.1 Hz down"},
    {command::frequency_up_1_hz, "1 Hz up"},
    {command::frequency_down_1_hz, "1 Hz down"},
    {command::frequency_query, "scan frequency?"},
    {command::constant_frequency_on, "constant frequency on"},
    {command::constant_frequency_off, "constant frequency off"},
    {command::restart_old, "restart"},
    {command::start, "start"},
    {command::stop, "stop"},
    {command::restart, "restart"},
    {command::device_info, "device information?"},
    {command::health, "health?"},
    {command::health_vendor, "health?"},
    {command::sample_rate_next, "next sample rate"},
    {command::sample_rate_query, "sample rate?"},
    {command::protection_toggle, "protection on or off"},
}};

/// "A5 60"
std::string& add_hex(std::string& to, bytes data) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  bool is_first = true;
  for (const std::uint8_t byte : data) {
    if (!std::exchange(is_first, false)) to += ' ';
    to += digits[byte >> 4U];
    to += digits[byte & 0x0FU];
  }
  return to;
}

std::string degrees(int angle_64ths) { return in_column(6, with_decimals(angle_64ths / 64.0, 2)); }

/// The meaning of a byte as the answer to `asked`.
std::string meaning_of_byte(std::uint8_t asked, std::uint8_t value) {
  constexpr std::array<const char*, 3> khz{"4 kHz", "8 kHz", "9 kHz"};
  switch (static_cast<command>(asked)) {
    case command::sample_rate_next:
    case command::sample_rate_query:
      return std::string("sample rate ") + (value < khz.size() ? khz[value] : "?");
    case command::motor_clockwise:
    case command::motor_counter_clockwise:
    case command::motor_direction_query:
      return value == 0 ? "clockwise" : "counter-clockwise";
    case command::low_power_on:
    case command::low_power_off:
    case command::low_power_query:
      return value == 0 ? "low power off" : "low power on";
    case command::constant_frequency_on:
    case command::constant_frequency_off:
      return value == 0 ? "constant frequency off" : "constant frequency on";
    case command::protection_toggle:
      return value == 0 ? "protection on" : "protection off";
    default:
      return "byte " + std::to_string(value);
  }
}

std::string words_for(packet_view packet) {
  const std::size_t count = packet.sample_count();
  std::string words = "packet " + degrees(packet.first_angle_64ths()) + " to " +
                      degrees(packet.last_angle_64ths()) + " deg, " +
                      in_column(2, std::to_string(count)) +
                      (count == 1 ? " sample, checksum ok" : " samples, checksum ok");
  if (packet.is_zero()) words += ", zero packet";
  if (packet.reported_frequency_chz() > 0) {
    words += ", " + with_decimals(packet.reported_frequency_chz() / 100.0, 1) + " Hz";
  }
  if (packet.is_suspect()) words += ", suspect: its angles go back";
  return words;
}

const char* words_for(skip_reason reason) {
  constexpr std::array<const char*, skip_reasons> words{"noise", "bad header", "bad checksum",
                                                        "truncated"};
  return words[static_cast<std::size_t>(reason)];
}

}  // namespace

std::string_view word_for_command(std::uint8_t code) noexcept {
  const auto* const found =
      std::find_if(command_words.begin(), command_words.end(),
                   [code](const auto& entry) { return entry.first == static_cast<command>(code); });
  return found == command_words.end() ? "no command" : found->second;
}

protocol_log::protocol_log(const protocol_log_style& style, const time_shift& times, text_sink& out)
    : style_(style), times_(times), out_(out), parser_(style.format) {}

void protocol_log::from_device(bytes data, std::int64_t time_ns) {
  now_ns_ = time_ns;
  bytes_ += data.size();
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(taken_));
  taken_ = 0;
  pending_.insert(pending_.end(), data.begin(), data.end());
  parser_.feed(data, [this](const event& found) { take(found); });
}

void protocol_log::to_device(bytes data, std::int64_t time_ns) {
  settle();
  now_ns_ = time_ns;
  while (data.size() >= 2 && data[0] == command_start) {
    asked_ = data[1];
    ++commands_;
    if (!style_.errors) write_line('>', word_for_command(asked_), data.first(2), time_ns, place_);
    data = data.subspan(2);
  }
  if (!data.empty() && !style_.errors) write_line('>', "no command", data, time_ns, place_);
}

void protocol_log::remark(std::string_view words, std::int64_t time_ns) {
  settle();
  if (!style_.errors) write_line('-', words, {}, time_ns, place_);
}

void protocol_log::finish() {
  while (const auto found = parser_.finish()) take(*found);
  settle();
}

void protocol_log::settle() {
  if (skipped_.empty()) return;
  const std::vector<std::uint8_t> gone = std::exchange(skipped_, {});
  const std::string words =
      "skipped " + std::to_string(gone.size()) + (gone.size() == 1 ? " byte: " : " bytes: ");
  write_line('!', words + words_for(reason_), gone, skipped_ns_, place_ - gone.size());
}

void protocol_log::take(const event& found) {
  counts_.add(found);
  const std::size_t size = size_of(found);
  if (const auto* gone = std::get_if<skipped>(&found)) {
    take(*gone);
  } else {
    settle();
    if (const auto* packet = std::get_if<packet_view>(&found)) take(*packet);
    if (const auto* response = std::get_if<response_view>(&found)) take(*response);
    if (const auto* time = std::get_if<time_packet_view>(&found)) take(*time);
    if (const auto* empty = std::get_if<empty_packet_view>(&found)) take(*empty);
  }
  taken_ += size;
  place_ += size;
}

void protocol_log::take(packet_view packet) {
  if (style_.errors && !packet.is_suspect()) return;
  write_line(packet.is_suspect() ? '!' : '<', words_for(packet), packet.data(), now_ns_, place_);
}

void protocol_log::take(response_view response) {
  if (style_.errors) return;
  write_line('<', meaning_of(response), response.data(), now_ns_, place_);
}

void protocol_log::take(time_packet_view packet) {
  if (style_.errors) return;
  const std::string words = "time packet: " + std::to_string(packet.milliseconds()) + " ms";
  write_line('<', words, packet.data(), now_ns_, place_);
}

void protocol_log::take(empty_packet_view packet) {
  if (!style_.errors) write_line('<', "packet without samples", packet.data(), now_ns_, place_);
}

void protocol_log::take(skipped gone) {
  constexpr std::size_t longest = 65'536;  // of a line; endless noise gives several
  if (!skipped_.empty() && (gone.reason != reason_ || skipped_.size() >= longest)) settle();
  if (skipped_.empty()) {
    reason_ = gone.reason;
    skipped_ns_ = now_ns_;
  }
  const bytes data = bytes(pending_).subspan(taken_, gone.count);
  skipped_.insert(skipped_.end(), data.begin(), data.end());
}

std::string protocol_log::meaning_of(response_view response) const {
  switch (response.kind()) {
    case response_kind::scan_started:
      return "scan started";
    case response_kind::device_info:
      if (const auto info = response.as_device_info()) {
        const model* const two_way = model_with_id(info->model, link_kind::two_way);
        const model* const known =
            two_way != nullptr ? two_way : model_with_id(info->model, link_kind::one_way);
        return "device information: model " + std::to_string(info->model) +
               (known != nullptr ? " (" + std::string(known->name) + ")" : "") + ", firmware " +
               std::to_string(info->firmware_major) + "." + std::to_string(info->firmware_minor) +
               ", hardware " + std::to_string(info->hardware) + ", serial " +
               std::string(info->serial_number());
      }
      break;
    case response_kind::health:
      if (const auto reply = response.as_health()) {
        return std::string("health: ").append(name_of(reply->status)) + ", code " +
               std::to_string(reply->error_code);
      }
      break;
    case response_kind::byte:
      if (const auto value = response.as_byte()) return meaning_of_byte(asked_, *value);
      break;
    case response_kind::frequency:
      if (const auto chz = response.as_frequency_chz()) {
        return "scan frequency " + with_decimals(*chz / 100.0, 2) + " Hz";
      }
      break;
    case response_kind::pitch:
      if (const auto cdeg = response.as_angle()) {
        return "pitch " + with_decimals(*cdeg / 100.0, 2) + " degrees";
      }
      break;
  }
  return "reply";
}

void protocol_log::write_line(char mark, std::string_view words, bytes data, std::int64_t time_ns,
                              std::uint64_t place) {
  constexpr std::size_t row = 16;
  if (is_done()) return;
  ++lines_;
  std::string line;
  if (style_.has_times) {
    times_.arrived(time_ns);
    std::array<char, 20> seconds;
    line.append(seconds.data(), put_seconds(seconds.data(), times_.of(time_ns)));
  } else {
    line = in_column(8, std::to_string(place));
  }
  ((line += ' ') += mark) += ' ';
  line += printable(words);
  // Commands and skipped bytes are always shown in hex; others on request.
  if (!style_.hex && !data.empty() && mark != '<') {
    add_hex(line += "  ", data.first(std::min(data.size(), row)));
    if (data.size() > row) line += " ...";
  }
  line += '\n';
  while (style_.hex && !data.empty()) {
    const bytes part = data.first(std::min(data.size(), row));
    add_hex(line += "    ", part) += '\n';
    data = data.subspan(part.size());
  }
  out_.write(line);
}

}  // namespace g4_tool
