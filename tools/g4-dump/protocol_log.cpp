// SPDX-License-Identifier: MIT
#include "protocol_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include "command_words.hpp"
#include "g4lidar/command.hpp"

namespace g4_dump {
namespace {

using g4lidar::command;

std::string in_hex(g4lidar::bytes data) {
  std::string text;
  for (const std::uint8_t byte : data)
    text += fmt::format("{}{:02X}", text.empty() ? "" : " ", byte);
  return text;
}

double in_degrees(int angle_64ths) { return angle_64ths / 64.0; }

/// What a byte says as the answer to `asked`.
std::string meaning_of_byte(std::uint8_t asked, std::uint8_t value) {
  constexpr std::array<const char*, 3> khz{"4 kHz", "8 kHz", "9 kHz"};
  switch (static_cast<command>(asked)) {
    case command::ranging_next:
    case command::ranging_query:
      return fmt::format("ranging frequency {}", value < khz.size() ? khz[value] : "?");
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
      return fmt::format("byte {}", value);
  }
}

std::string words_for(g4lidar::packet_view packet) {
  const std::size_t count = packet.sample_count();
  std::string words =
      fmt::format("packet {:6.2f} to {:6.2f} deg, {:2} sample{}, checksum ok",
                  in_degrees(packet.first_angle_64ths()), in_degrees(packet.last_angle_64ths()),
                  count, count == 1 ? "" : "s");
  if (packet.is_zero()) words += ", zero packet";
  if (packet.reported_frequency_dhz() > 0) {
    words += fmt::format(", {:.1f} Hz", packet.reported_frequency_dhz() / 10.0);
  }
  if (packet.is_suspect()) words += ", suspect: its angles go back";
  return words;
}

const char* words_for(g4lidar::skip_reason reason) {
  switch (reason) {
    case g4lidar::skip_reason::noise:
      return "noise";
    case g4lidar::skip_reason::bad_header:
      return "bad header";
    case g4lidar::skip_reason::bad_checksum:
      return "bad checksum";
    case g4lidar::skip_reason::truncated:
      break;
  }
  return "truncated";
}

}  // namespace

void protocol_log::from_device(g4lidar::bytes data, std::int64_t time_ns) {
  now_ns_ = time_ns;
  bytes_ += data.size();
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(taken_));
  taken_ = 0;
  pending_.insert(pending_.end(), data.begin(), data.end());
  parser_.feed(data, [this](const g4lidar::event& found) { take(found); });
}

void protocol_log::to_device(g4lidar::bytes data, std::int64_t time_ns) {
  settle();
  now_ns_ = time_ns;
  while (data.size() >= 2 && data[0] == g4lidar::command_start) {
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
  write_line('!',
             fmt::format("skipped {} byte{}: {}", gone.size(), gone.size() == 1 ? "" : "s",
                         words_for(reason_)),
             gone, skipped_ns_, place_ - gone.size());
}

void protocol_log::take(const g4lidar::event& found) {
  counts_.add(found);
  std::size_t size = 0;
  if (const auto* gone = std::get_if<g4lidar::skipped>(&found)) {
    size = gone->count;
    take(*gone);
  } else if (const auto* packet = std::get_if<g4lidar::packet_view>(&found)) {
    settle();
    size = packet->data().size();
    take(*packet);
  } else if (const auto* response = std::get_if<g4lidar::response_view>(&found)) {
    settle();
    size = response->data().size();
    take(*response);
  }
  taken_ += size;
  place_ += size;
}

void protocol_log::take(g4lidar::packet_view packet) {
  if (style_.errors && !packet.is_suspect()) return;
  write_line(packet.is_suspect() ? '!' : '<', words_for(packet), packet.data(), now_ns_, place_);
}

void protocol_log::take(g4lidar::response_view response) {
  if (style_.errors) return;
  write_line('<', meaning_of(response), response.data(), now_ns_, place_);
}

void protocol_log::take(g4lidar::skipped gone) {
  constexpr std::size_t longest = 65'536;  // of a line; an endless noise makes several
  if (!skipped_.empty() && (gone.reason != reason_ || skipped_.size() >= longest)) settle();
  if (skipped_.empty()) {
    reason_ = gone.reason;
    skipped_ns_ = now_ns_;
  }
  const g4lidar::bytes bytes = g4lidar::bytes(pending_).subspan(taken_, gone.count);
  skipped_.insert(skipped_.end(), bytes.begin(), bytes.end());
}

std::string protocol_log::meaning_of(g4lidar::response_view response) const {
  switch (response.kind()) {
    case g4lidar::response_kind::scan_started:
      return "scan started";
    case g4lidar::response_kind::device_info:
      if (const auto info = response.as_device_info()) {
        return fmt::format("device information: model {}{}, firmware {}.{}, hardware {}, serial {}",
                           info->model, info->model == g4lidar::model_g4 ? " (G4)" : "",
                           info->firmware_major, info->firmware_minor, info->hardware,
                           info->serial_number());
      }
      break;
    case g4lidar::response_kind::health:
      if (const auto said = response.as_health()) {
        constexpr std::array<const char*, 3> words{"ok", "warning", "error"};
        return fmt::format("health: {}, code {}", words[static_cast<std::size_t>(said->status)],
                           said->error_code);
      }
      break;
    case g4lidar::response_kind::byte:
      if (const auto value = response.as_byte()) return meaning_of_byte(asked_, *value);
      break;
    case g4lidar::response_kind::frequency:
      if (const auto chz = response.as_frequency_chz()) {
        return fmt::format("scan frequency {:.2f} Hz", *chz / 100.0);
      }
      break;
  }
  return "reply";
}

void protocol_log::write_line(char mark, std::string_view words, g4lidar::bytes data,
                              std::int64_t time_ns, std::uint64_t place) {
  constexpr std::size_t row = 16;
  if (is_done()) return;
  ++lines_;
  std::string line;
  if (style_.has_times) {
    times_.come(time_ns);
    const std::int64_t shown_ns = times_.of(time_ns);
    const auto us = static_cast<std::uint64_t>(shown_ns < 0 ? -shown_ns : shown_ns) / 1'000U;
    line = fmt::format("{}{}.{:06} {} {}", shown_ns < 0 ? "-" : "", us / 1'000'000U,
                       us % 1'000'000U, mark, words);
  } else {
    line = fmt::format("{:8} {} {}", place, mark, words);
  }
  // Commands and what was skipped show their bytes always; the rest where it is asked for.
  if (!style_.hex && !data.empty() && mark != '<') {
    line += "  " + in_hex(data.first(std::min(data.size(), row)));
    if (data.size() > row) line += " ...";
  }
  out_.write(line + "\n");
  if (!style_.hex) return;
  for (; !data.empty(); data = data.subspan(std::min(data.size(), row))) {
    out_.write("    " + in_hex(data.first(std::min(data.size(), row))) + "\n");
  }
}

}  // namespace g4_dump
