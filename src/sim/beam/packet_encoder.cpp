// SPDX-License-Identifier: MIT
#include "sim/exact.hpp"

#include "packet_encoder.hpp"

#include <cstddef>

#include "g4lidar/core/angle.hpp"

namespace g4lidar::sim {
namespace {

// The nearest 1/64 of a degree, and the check bit.
unsigned wire_angle(double degrees) noexcept {
  constexpr unsigned turn = 360 * 64;
  const auto nearest = static_cast<unsigned>(degrees * 64.0 + 0.5);
  return nearest % turn * 2 + 1;
}

// Writes words, and their exclusive or.
class word_writer {
 public:
  explicit word_writer(std::span<std::uint8_t, longest_packet> out) noexcept : out_(out) {}

  void put(unsigned word) noexcept {
    out_[size_++] = static_cast<std::uint8_t>(word % 256);
    out_[size_++] = static_cast<std::uint8_t>(word / 256);
    sum_ ^= word;
  }
  /// One byte, which counts as a word with the upper byte 0.
  void put_byte(unsigned byte) noexcept {
    out_[size_++] = static_cast<std::uint8_t>(byte);
    sum_ ^= byte;
  }
  /// Writes the checksum to its place.
  [[nodiscard]] bytes finish(std::size_t sum_at) noexcept {
    out_[sum_at] = static_cast<std::uint8_t>(sum_ % 256);
    out_[sum_at + 1] = static_cast<std::uint8_t>(sum_ / 256);
    return out_.first(size_);
  }

 private:
  std::span<std::uint8_t, longest_packet> out_;
  std::size_t size_ = 0;
  unsigned sum_ = 0;
};

void put_sample(word_writer& to, const sample_truth& sample, const sample_code& code) noexcept {
  const unsigned intensity = sample.intensity;
  if (code.intensity_bytes == 1) to.put_byte(intensity % 256);
  if (code.intensity_bytes == 2) to.put(intensity);
  if (code.lower == lower_bits::range) return to.put(sample.raw);
  const unsigned lower = code.lower == lower_bits::flags ? sample.flags : intensity / 256;
  to.put(sample.raw * 4U + lower);
}

unsigned sent_angle(double degrees, double zero_deg) noexcept {
  return wire_angle(zero_deg == 0.0 ? degrees : wrap_once_deg(degrees - zero_deg));
}

}  // namespace

bytes encode_packet(std::span<std::uint8_t, longest_packet> out, std::uint8_t ct,
                    std::span<const sample_truth> samples, const sample_code& code,
                    double zero_deg) noexcept {
  word_writer to(out);
  to.put(0x55AA);
  to.put(ct + 256U * static_cast<unsigned>(samples.size()));
  to.put(sent_angle(samples.front().first_level_deg, zero_deg));
  to.put(sent_angle(samples.back().first_level_deg, zero_deg));
  to.put(0);  // the place of the checksum
  for (const sample_truth& each : samples) put_sample(to, each, code);
  return to.finish(packet_head_bytes - 2);
}

std::uint8_t crc_with(std::uint8_t crc, std::uint8_t byte) noexcept {
  unsigned rest = unsigned{crc} ^ byte;
  for (int bit = 0; bit < 8; ++bit) rest = rest / 2 ^ (rest % 2 != 0 ? 0x8CU : 0U);
  return static_cast<std::uint8_t>(rest);
}

}  // namespace g4lidar::sim
