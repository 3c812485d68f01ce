// SPDX-License-Identifier: MIT
#include "layout_votes.hpp"

#include <algorithm>

#include "g4lidar/core/packet.hpp"

namespace g4lidar {
namespace {

constexpr std::size_t header_size = 10;
constexpr std::array<std::size_t, 3> sample_sizes{2, 3, 4};
/// The begin of the next frame, and the byte that some devices send before a zero packet.
constexpr std::size_t behind_size = 3;
constexpr std::size_t largest_size = header_size + 4 * max_samples + behind_size;
constexpr std::uint64_t clear_lead = 3;

bool begins_frame(bytes data) noexcept {
  return (data[0] == 0xAA && (data[1] == 0x55 || data[1] == 0x66)) ||
         (data[0] == 0xA5 && data[1] == 0x5A);
}

/// The exclusive or of all words but the checksum; of a sample of 3 bytes the first is a word of its own.
bool has_right_checksum(bytes frame, std::size_t sample_size) noexcept {
  std::uint16_t sum = 0;
  for (std::size_t i = 0; i < header_size; i += 2) sum ^= load_u16(frame, i);  // with it: 0 remains
  for (std::size_t i = header_size; i < frame.size(); i += sample_size) {
    if (sample_size == 3) sum ^= frame[i];
    if (sample_size == 4) sum ^= load_u16(frame, i);
    sum ^= load_u16(frame, i + sample_size - 2);
  }
  return sum == 0;
}

}  // namespace

void layout_votes::take(bytes input) {
  held_.insert(held_.end(), input.begin(), input.end());
  std::size_t at = 0;
  for (; at + largest_size <= held_.size(); ++at) {
    if (held_[at] == 0xAA && held_[at + 1] == 0x55) look_at(bytes(held_).subspan(at));
  }
  held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(at));
}

void layout_votes::finish() {
  std::array<std::uint8_t, largest_size> end{0xAA, 0x55};
  take(end);
}

void layout_votes::look_at(bytes frame) {
  const std::size_t samples = frame[3];
  if (samples == 0 || samples > max_samples) return;
  for (const std::size_t size : sample_sizes) {
    const std::size_t end = header_size + size * samples;
    const bool is_followed =
        begins_frame(frame.subspan(end)) || begins_frame(frame.subspan(end + 1));
    if (is_followed && has_right_checksum(frame.first(end), size)) ++votes_.at(size);
  }
}

std::size_t layout_votes::sample_bytes() const noexcept {
  const auto best = std::max_element(votes_.begin(), votes_.end());
  const std::uint64_t most = *best;
  const bool is_clear = std::ranges::all_of(votes_, [&](const std::uint64_t& each) {
    return &each == &*best || most >= each + clear_lead;
  });
  return is_clear ? static_cast<std::size_t>(best - votes_.begin()) : 0;
}

}  // namespace g4lidar
