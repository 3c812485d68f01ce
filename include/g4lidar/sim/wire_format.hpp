// SPDX-License-Identifier: MIT
// What the scanners of the models of the family differ in: the bytes of a sample, the beam, the
// rates. Nothing here is code or a number of the core, so that each can verify the other.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "g4lidar/sim/ray_caster.hpp"

namespace g4lidar::sim {

/// The largest number of samples in a packet of any model.
inline constexpr std::size_t most_samples = 80;
/// The bytes of a packet before its samples.
inline constexpr std::size_t packet_head_bytes = 10;
/// The bytes of the longest packet of any model.
inline constexpr std::size_t longest_packet = packet_head_bytes + 2 * most_samples;

/// What the lower two bits of the word of a range are.
enum class lower_bits : std::uint8_t {
  range,      ///< A part of the range.
  flags,      ///< Flags of the sample.
  intensity,  ///< The upper two bits of its intensity.
};

/// How a sample is written: bytes of intensity, then the 16-bit word of the range, all little-endian.
struct sample_code {
  std::uint8_t intensity_bytes = 0;  ///< 0, 1 or 2.
  std::uint8_t units_per_mm = 4;     ///< Of the number that is the range.
  lower_bits lower = lower_bits::range;

  /// The bytes of a sample.
  [[nodiscard]] constexpr std::size_t size() const noexcept {
    return std::size_t{2} + intensity_bytes;
  }
  /// The largest number that the range can be.
  [[nodiscard]] constexpr std::uint16_t largest() const noexcept {
    return lower == lower_bits::range ? 0xFFFF : 0x3FFF;
  }
  /// The largest intensity; 0 if there is none.
  [[nodiscard]] constexpr std::uint16_t brightest() const noexcept {
    if (intensity_bytes != 1) return intensity_bytes == 0 ? 0 : 0xFFFF;
    return lower == lower_bits::intensity ? 0x3FF : 0xFF;
  }

  friend constexpr bool operator==(const sample_code&, const sample_code&) = default;
};

/// The scanner of a model. By default that of a G4.
struct wire_format {
  sample_code code{};
  beam_shape beam = triangle_beam;
  /// Samples per second, in the order of their codes; 0: no further one.
  std::array<std::uint32_t, 3> rates_hz{4000, 8000, 9000};
  /// The codes that some devices answer for these instead.
  std::array<std::uint8_t, 3> other_rate_codes{0, 1, 2};
  std::uint16_t min_frequency_chz = 500;    ///< Revolutions per 100 s, at least.
  std::uint16_t max_frequency_chz = 1200;   ///< The same, at most.
  std::uint8_t max_samples = most_samples;  ///< In a packet.
  std::int8_t ct_offset_dhz = 0;  ///< What is missing in the reported frequency, in 0.1 Hz.
  std::uint8_t usual_flags = 0;   ///< Of most returns, where samples have flags.
  bool is_turned = true;          ///< Angle 0 is opposite to where the lidar looks.
};

}  // namespace g4lidar::sim
