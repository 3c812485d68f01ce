// SPDX-License-Identifier: MIT
#include "other_makers.hpp"

#include <algorithm>
#include <numeric>

#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/response.hpp"

namespace g4lidar {
namespace {

/// The size of the frame at the front of `data`; 0: there is none.
using frame_size = std::size_t (*)(bytes data) noexcept;

/// Bytes that are collected before they are examined.
constexpr std::size_t least_new = 64;
constexpr unsigned with_checksum = 5;
constexpr unsigned without_checksum = 50;

struct kind {
  other_maker maker;
  frame_size size;
  unsigned enough;  // frames in a row
};

template <std::size_t Count>
bool begins(bytes data, const std::array<std::uint8_t, Count>& start) noexcept {
  return data.size() >= Count && std::equal(start.begin(), start.end(), data.begin());
}

std::uint8_t sum_of(bytes data) noexcept {
  return static_cast<std::uint8_t>(std::accumulate(data.begin(), data.end(), 0U));
}

/// Big-endian, as in frames of a Delta.
std::size_t load_upper_first(bytes data, std::size_t offset) noexcept {
  return data[offset] * 256U + data[offset + 1];
}

std::size_t ldrobot(bytes data) noexcept {
  constexpr std::size_t size = 47;
  if (data.size() < size || data[0] != 0x54 || data[1] != 0x2C) return 0;
  unsigned crc = 0;
  for (const std::uint8_t byte : data.first(size - 1)) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit)
      crc = ((crc << 1U) ^ ((crc & 0x80U) != 0 ? 0x4DU : 0U)) & 0xFFU;
  }
  return crc == data[size - 1] ? size : 0;
}

std::size_t neato(bytes data) noexcept {
  constexpr std::size_t size = 22;
  if (data.size() < size || data[0] != 0xFA || data[1] < 0xA0 || data[1] > 0xF9) return 0;
  std::uint32_t sum = 0;
  for (std::size_t at = 0; at < size - 2; at += 2) sum = (sum << 1U) + load_u16(data, at);
  sum = ((sum & 0x7FFFU) + (sum >> 15U)) & 0x7FFFU;
  return sum == load_u16(data, size - 2) ? size : 0;
}

/// Its checksum is computed in several ways.
std::size_t hls_lfcd(bytes data) noexcept {
  constexpr std::size_t size = 42;
  const bool is_frame =
      data.size() >= size && data[0] == 0xFA && data[1] >= 0xA0 && data[1] < 0xA0 + 60;
  return is_frame ? size : 0;
}

std::size_t delta(bytes data) noexcept {
  constexpr std::size_t head = 8;
  constexpr std::size_t most = 300;
  if (data.size() < head + 2 || data[0] != 0xAA || data[3] > 1 || data[4] != 0x61) return 0;
  if (data[5] != 0xAD && data[5] != 0xAE) return 0;
  const std::size_t summed = load_upper_first(data, 1);
  if (summed < head || summed > most || data.size() < summed + 2) return 0;
  const bytes all = data.first(summed);
  const unsigned sum = std::accumulate(all.begin(), all.end(), 0U) & 0xFFFFU;
  return sum == load_upper_first(data, summed) ? summed + 2 : 0;
}

/// How its checksum is computed is not public.
std::size_t camsense(bytes data) noexcept {
  constexpr std::size_t size = 36;
  return data.size() >= size && begins(data, std::array<std::uint8_t, 4>{0x55, 0xAA, 0x03, 0x08})
             ? size
             : 0;
}

std::size_t line_sensor(bytes data) noexcept {
  constexpr std::size_t head = 8;
  constexpr std::size_t most = 400;
  constexpr std::array<std::uint8_t, 4> start{0xA5, 0xA5, 0xA5, 0xA5};
  if (data.size() < head || !begins(data, start)) return 0;
  const std::size_t summed = head + load_u16(data, 6);
  if (summed > most || data.size() <= summed) return 0;
  return sum_of(data.subspan(start.size(), summed - start.size())) == data[summed] ? summed + 1 : 0;
}

std::size_t range_finder(bytes data) noexcept {
  constexpr std::size_t head = 4;
  constexpr std::size_t most = 8;
  if (data.size() <= head || data[0] != 0xAA || data[1] != 0x55 || data[2] != 0x60) return 0;
  const std::size_t summed = head + data[3];
  if (data[3] < 2 || data[3] > most || data.size() <= summed) return 0;
  return sum_of(data.first(summed)) == data[summed] ? summed + 1 : 0;
}

/// Capsules of an express scan: of 84 bytes, or of 132 with two ranges in one word.
std::size_t capsule(bytes data, std::size_t size) noexcept {
  if (data.size() < size || data[0] >> 4U != 0xA || data[1] >> 4U != 5) return 0;
  unsigned sum = 0;
  for (const std::uint8_t byte : data.subspan(2, size - 2)) sum ^= byte;
  return sum == ((data[0] & 0xFU) | (data[1] & 0xFU) << 4U) ? size : 0;
}
std::size_t short_capsule(bytes data) noexcept { return capsule(data, 84); }
std::size_t long_capsule(bytes data) noexcept { return capsule(data, 132); }

/// A sample of a standard scan: a start bit and its inverse, a bit that is always 1, and an angle. The start bit is set once
/// in a turn: not in one byte again and again.
std::size_t slamtec_sample(bytes data) noexcept {
  constexpr std::size_t size = 5;
  constexpr unsigned full_turn = 360 * 64;
  if (data.size() < size) return 0;
  if (data.size() > size && (data[0] & data[size] & 1U) != 0) return 0;
  const bool has_start = ((data[0] ^ data[0] >> 1U) & 1U) == 1;
  const bool is_sample = has_start && (data[1] & 1U) == 1 && load_u16(data, 1) >> 1U < full_turn;
  return is_sample ? size : 0;
}

/// The begin of a scan, and what only this maker sends behind it: a capsule of an express scan, or samples of five bytes.
/// The answer itself may be one of a YDLIDAR.
std::size_t slamtec_scan(bytes data) noexcept {
  constexpr std::size_t head = 7;
  constexpr std::size_t samples = 10;
  if (data.size() <= head || !begins(data, response_start) || data[5] != 0x40) return 0;
  const bytes rest = data.subspan(head);
  const std::size_t size = data[2];
  const bool is_known = data[3] == 0 && data[4] == 0;
  if (!is_known || begins(rest, packet_start)) return 0;
  const std::uint8_t type = data[6];
  if (type == 0x81 && size == 5) {
    std::size_t at = 0;
    while (at < samples * size && slamtec_sample(rest.subspan(std::min(at, rest.size()))) != 0)
      at += size;
    return at == samples * size ? head : 0;
  }
  if ((type == 0x82 || type == 0x85) && size == 84) return short_capsule(rest) == 0 ? 0 : head;
  return type == 0x84 && size == 132 && long_capsule(rest) != 0 ? head : 0;
}

/// A device information like that of a YDLIDAR, but with a serial number that is not of decimal digits. Another answer
/// follows, or nothing: so no byte of it was lost.
std::size_t slamtec_information(bytes data) noexcept {
  constexpr std::array<std::uint8_t, 7> start{0xA5, 0x5A, 0x14, 0x00, 0x00, 0x00, 0x04};
  constexpr std::size_t size = 27;
  constexpr std::size_t digits = 16;
  if (data.size() < size || !begins(data, start)) return 0;
  if (data.size() > size && !begins(data.subspan(size), response_start)) return 0;
  const bytes serial = data.subspan(size - digits, digits);
  const auto above = [&](unsigned most) {
    return std::count_if(serial.begin(), serial.end(), [&](unsigned each) { return each > most; });
  };
  return above(9) >= 12 && above('z') >= 2 ? size : 0;
}

std::size_t coin_greeting(bytes data) noexcept {
  constexpr std::array<std::uint8_t, 16> start{0xFA, 0xFA, 0xA5, 0x5A, 0x14, 0x00, 0xE3, 0x02,
                                               0x01, 'C',  'O',  'I',  'N',  '-',  'D',  '4'};
  return begins(data, start) ? start.size() : 0;
}

/// "$GNGGA,...*58\r\n". Its form is as good as a checksum, which is not compared: receivers differ.
std::size_t nmea_sentence(bytes data) noexcept {
  constexpr std::size_t word = 6;  // '$', talker and kind
  constexpr std::size_t most = 100;
  if (data.size() <= word || data[0] != '$' || data[word] != ',') return 0;
  const auto is_capital = [](std::uint8_t c) { return c >= 'A' && c <= 'Z'; };
  const bytes kind = data.subspan(1, word - 1);
  if (!std::all_of(kind.begin(), kind.end(), is_capital)) return 0;
  for (std::size_t at = word; at < std::min(data.size(), most); ++at) {
    if (data[at] == '\n') return data[at - 1] == '\r' ? at + 1 : 0;
    if (data[at] != '\r' && (data[at] < ' ' || data[at] > '~')) return 0;
  }
  return 0;
}

constexpr std::string_view slamtec = "an RPLIDAR of Slamtec";
constexpr std::string_view slamtec_driver = "sllidar_ros2";

constexpr std::array<kind, 14> kinds{{
    {{"an LD06, LD14, LD19 or STL of LDROBOT", "ldlidar_stl_ros2", "54 2C, the CRC is right"},
     ldrobot,
     with_checksum},
    {{"an XV-11 of Neato, or an LDS with its frames", "xv_11_driver", "FA, the checksum is right"},
     neato,
     with_checksum},
    {{"an LDS-01 (HLS-LFCD) of Hitachi-LG", "hls_lfcd_lds_driver", "FA, 42 bytes"},
     hls_lfcd,
     without_checksum},
    {{"a Delta of 3irobotix", "delta_lidar", "AA, the checksum is right"}, delta, with_checksum},
    {{"a Camsense X1", "camsense_driver", "55 AA 03 08, 36 bytes"}, camsense, without_checksum},
    {{"a GS of YDLIDAR, a line sensor", "YDLidar-SDK", "A5 A5 A5 A5, the checksum is right"},
     line_sensor,
     with_checksum},
    {{"an SDM of YDLIDAR, a range finder", "YDLidar-SDK", "AA 55 60, the checksum is right"},
     range_finder,
     with_checksum},
    {{slamtec, slamtec_driver, "express scan, the checksum is right"},
     short_capsule,
     with_checksum},
    {{slamtec, slamtec_driver, "express scan, the checksum is right"}, long_capsule, with_checksum},
    {{slamtec, slamtec_driver, "standard scan, samples of 5 bytes"},
     slamtec_sample,
     without_checksum},
    {{slamtec, slamtec_driver, "the begin of its scan"}, slamtec_scan, 1},
    {{slamtec, slamtec_driver, "its device information"}, slamtec_information, 1},
    {{"a COIN-D4 (LDS-03)", "coin_d4_driver, or this library: --model t-mini-pro --listen",
      "its greeting"},
     coin_greeting,
     1},
    {{"a receiver of satellite positions (NMEA)", "", "$, sentences of text"},
     nmea_sentence,
     with_checksum},
}};

constexpr auto makers = [] {
  std::array<other_maker, kinds.size()> all{};
  std::transform(kinds.begin(), kinds.end(), all.begin(), [](const kind& of) { return of.maker; });
  return all;
}();

}  // namespace

std::span<const other_maker> other_makers() noexcept { return makers; }

std::string with_driver(const other_maker& of) {
  std::string text(of.product);
  if (!of.driver.empty()) text.append("; its driver is ").append(of.driver);
  return text;
}

/// Looks for frames that begin before `until` in what is held.
void maker_recogniser::look(std::size_t until) noexcept {
  static_assert(kinds.size() <= most_kinds);
  for (std::size_t at = 0; at < until && found_ == nullptr; ++at) {
    const bytes rest = bytes(held_).first(size_).subspan(at);
    const std::uint64_t here = begin_ + at;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      run& of = runs_[i];
      if (here < of.end) continue;  // within a frame of this kind
      const std::size_t size = kinds[i].size(rest);
      of.frames = size == 0 ? 0 : of.frames + 1;
      if (size == 0) continue;
      of.end = here + size;
      if (of.frames >= kinds[i].enough) found_ = &makers[i];
    }
  }
  const std::size_t taken = std::min(until, size_);
  std::copy(held_.begin() + static_cast<std::ptrdiff_t>(taken),
            held_.begin() + static_cast<std::ptrdiff_t>(size_), held_.begin());
  size_ -= taken;
  begin_ += taken;
}

void maker_recogniser::take(bytes input) noexcept {
  while (!input.empty() && found_ == nullptr) {
    const std::size_t count = std::min(input.size(), held_.size() - size_);
    std::copy_n(input.begin(), count, held_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += count;
    input = input.subspan(count);
    if (size_ >= longest + least_new) look(size_ - longest);
  }
}

void maker_recogniser::finish() noexcept { look(size_); }

bool maker_recogniser::is_likely() const noexcept {
  maker_recogniser all = *this;
  all.finish();
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (5 * all.runs_[i].frames >= kinds[i].enough) return true;
  }
  return false;
}

}  // namespace g4lidar
