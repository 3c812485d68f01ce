// SPDX-License-Identifier: MIT
// The parser's events as lines of text for transcripts; without a heap, so that it runs anywhere.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <variant>

#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/core/stream_parser.hpp"

namespace g4lidar::transcript {

/// A short line of text. Longer text is cut off.
class line {
 public:
  constexpr line& operator<<(std::string_view text) {
    for (const char c : text) {
      if (size_ < text_.size()) text_[size_++] = c;
    }
    return *this;
  }
  constexpr line& operator<<(std::size_t number) {
    std::array<char, 20> digits{};
    std::size_t first = digits.size();
    do {
      digits[--first] = static_cast<char>('0' + static_cast<int>(number % 10));
      number /= 10;
    } while (number > 0);
    return *this << std::string_view(digits.data() + first, digits.size() - first);
  }
  [[nodiscard]] constexpr std::string_view view() const& { return {text_.data(), size_}; }
  std::string_view view() const&& = delete;

 private:
  std::array<char, 120> text_{};
  std::size_t size_ = 0;
};

/// An angle in 1/64 of a degree, exactly: 1/64 is 0.015625.
constexpr void write_angle(line& out, int sixty_fourths) {
  const auto whole = static_cast<std::size_t>(sixty_fourths);
  const std::size_t millionths = whole % 64 * 15625;
  out << whole / 64 << ".";
  for (std::size_t digit = 100000; digit > 0; digit /= 10) out << millionths / digit % 10;
}

[[nodiscard]] constexpr line text_of(packet_view packet) {
  line out;
  out << "packet size=" << packet.data().size();
  if (packet.is_zero()) {
    out << " zero frequency_dhz=" << static_cast<std::size_t>(packet.reported_frequency_chz() / 10);
  }
  out << " samples=" << packet.sample_count() << " first_deg=";
  write_angle(out, packet.first_angle_64ths());
  out << " last_deg=";
  write_angle(out, packet.last_angle_64ths());
  if (packet.is_suspect()) out << " suspect";
  return out;
}

template <sample_layout Layout>
[[nodiscard]] constexpr line text_of_sample_in(packet_view packet, std::size_t i) {
  const std::uint16_t word = packet.sample(i);
  const auto hundredths = static_cast<std::size_t>(100.0F * range_mm_of<Layout>(word));
  line out;
  out << "sample range_mm=" << hundredths / 100 << "." << hundredths / 10 % 10 << hundredths % 10
      << " intensity=" << std::size_t{intensity_of<Layout>(packet.intensity_word(i), word)}
      << " flags=" << std::size_t{sample_flags_of<Layout>(word)};
  return out;
}
/// What sample `i` contains.
[[nodiscard]] constexpr line text_of_sample(packet_view packet, std::size_t i) {
  using enum sample_layout;
  switch (packet.layout()) {
    case flagged_mm:
      return text_of_sample_in<flagged_mm>(packet, i);
    case half_mm:
      return text_of_sample_in<half_mm>(packet, i);
    case whole_mm:
      return text_of_sample_in<whole_mm>(packet, i);
    case intensity_10:
      return text_of_sample_in<intensity_10>(packet, i);
    case intensity_8:
      return text_of_sample_in<intensity_8>(packet, i);
    case intensity_16:
      return text_of_sample_in<intensity_16>(packet, i);
    case quarter_mm:
      break;
  }
  return text_of_sample_in<quarter_mm>(packet, i);
}

[[nodiscard]] constexpr line text_of(response_view reply) {
  line out;
  out << "response ";
  if (const auto info = reply.as_device_info()) {
    out << "device_info model=" << std::size_t{info->model}
        << " firmware=" << std::size_t{info->firmware_major} << "."
        << std::size_t{info->firmware_minor} << " hardware=" << std::size_t{info->hardware}
        << " serial=" << info->serial_number();
  } else if (const auto condition = reply.as_health()) {
    out << "health status=" << static_cast<std::size_t>(condition->status)
        << " error_code=" << std::size_t{condition->error_code};
  } else if (const auto byte = reply.as_byte()) {
    out << "byte " << std::size_t{*byte};
  } else if (const auto frequency = reply.as_frequency_chz()) {
    out << "frequency_chz " << std::size_t{*frequency};
  } else {
    out << "scan_started";
  }
  return out;
}

[[nodiscard]] constexpr line text_of(const skipped& gone) {
  line out;
  out << "skipped " << gone.count << " " << name_of(gone.reason);
  return out;
}

[[nodiscard]] constexpr line text_of(time_packet_view packet) {
  line out;
  out << "time milliseconds=" << std::size_t{packet.milliseconds()};
  return out;
}

/// The bytes of a packet of any kind or a response; none for skipped ones.
[[nodiscard]] constexpr bytes data_of(const event& found) {
  if (const auto* packet = std::get_if<packet_view>(&found)) return packet->data();
  if (const auto* reply = std::get_if<response_view>(&found)) return reply->data();
  if (const auto* time = std::get_if<time_packet_view>(&found)) return time->data();
  if (const auto* empty = std::get_if<empty_packet_view>(&found)) return empty->data();
  return {};
}

}  // namespace g4lidar::transcript
