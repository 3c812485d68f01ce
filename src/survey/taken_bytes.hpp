// SPDX-License-Identifier: MIT
// Which control characters packets lack that are one byte too short.
#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>

#include "g4lidar/core/packet.hpp"

namespace g4lidar {

/// *Single thread, never allocates.* A terminal takes the same few characters each time; a bridge that drops bytes takes
/// any. Which one a packet lacks follows from its checksum: there is a place where it makes the packet valid.
class taken_bytes {
 public:
  using control_set = std::bitset<32>;

  void take(std::uint8_t byte) noexcept {
    if (size_ >= packet_.size()) size_ = 0;
    packet_[size_++] = byte;
    const bool starts =
        size_ >= 2 && packet_[size_ - 2] == packet_start[0] && byte == packet_start[1];
    if (!starts) {
      if (size_ == 2 && packet_[0] != packet_start[0]) {
        packet_[0] = byte;
        size_ = 1;
      }
      return;
    }
    judge(size_ - 2);
    std::copy(packet_start.begin(), packet_start.end(), packet_.begin());
    size_ = packet_start.size();
  }

  /// Those of `absent` whose lack explains nearly all short packets; empty: it does not, or there were few.
  [[nodiscard]] control_set found(const control_set& absent) const noexcept {
    constexpr std::uint32_t few = 6;
    std::uint32_t all = 0;
    control_set made;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (!absent.test(candidates[i])) continue;
      all += explained_[i];
      made.set(candidates[i], explained_[i] >= few / 2);  // fewer may be chance
    }
    return all >= few && 10 * all >= 9 * short_ ? made : control_set();
  }

 private:
  /// ^C, the carriage return, XON and XOFF.
  static constexpr std::array<std::uint8_t, 4> candidates{0x03, 0x0D, 0x11, 0x13};
  static constexpr std::array<sample_format, 3> formats{
      g4_format,
      {sample_layout::intensity_8, correction_kind::none},
      {sample_layout::intensity_16, correction_kind::none}};
  static constexpr std::uint32_t most = 64;  // short packets: more show nothing more
  static constexpr std::size_t header_size = 10;

  /// `size` bytes, from one start of a packet to the next.
  void judge(std::size_t size) noexcept {
    if (size < header_size || short_ >= most) return;
    const bytes data(packet_.data(), size);
    const auto size_as = [&](const sample_format& format) {
      return header_size + data[3] * sample_size(format.layout);
    };
    if (format_ == nullptr || size + 1 != size_as(*format_)) {
      for (const sample_format& each : formats) {
        if (size == size_as(each) && check_packet(data, each).state == wire_state::valid)
          format_ = &each;
      }
      return;
    }
    ++short_;
    for (std::size_t i = 0; i < candidates.size(); ++i)
      explained_[i] += lacks(data, candidates[i]) ? 1U : 0U;
  }

  /// Whether the packet is valid with the byte at one of the places behind the number of samples.
  [[nodiscard]] bool lacks(bytes data, std::uint8_t byte) const noexcept {
    std::array<std::uint8_t, capacity> whole{};
    std::size_t at = 4;
    std::copy_n(data.begin(), at, whole.begin());
    whole[at] = byte;
    std::copy(data.begin() + 4, data.end(), whole.begin() + 5);
    while (true) {
      if (check_packet(bytes(whole).first(data.size() + 1), *format_).state == wire_state::valid)
        return true;
      if (at == data.size()) return false;
      whole[at] = whole[at + 1];
      whole[++at] = byte;
    }
  }

  static constexpr std::size_t capacity = 256;  // a packet of 40 samples has 170 at most

  std::array<std::uint8_t, capacity - 1> packet_{};
  std::size_t size_ = 0;
  const sample_format* format_ = nullptr;  // of the last valid packet
  std::uint32_t short_ = 0;
  std::array<std::uint32_t, candidates.size()> explained_{};
};

}  // namespace g4lidar
