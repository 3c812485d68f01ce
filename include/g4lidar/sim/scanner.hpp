// SPDX-License-Identifier: MIT
// The measuring part of a simulated lidar: a rotating head, its samples, its packets, and in what models differ. Nothing
// here is code or a number of the core, so that each can verify the other.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/settings.hpp"
#include "g4lidar/sim/random.hpp"
#include "g4lidar/sim/ray_caster.hpp"
#include "g4lidar/sim/world.hpp"

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
  std::int16_t ct_offset_chz = 0;  ///< What is missing in the reported frequency, in 0.01 Hz.
  std::uint8_t usual_flags = 0;    ///< Of most returns, where samples have flags.
  bool is_turned = true;           ///< Angle 0 is opposite to where the lidar looks.
};

/// The direction of rotation, and its effect on the angles.
enum class turning : std::uint8_t {
  clockwise,  ///< The default of a G4.
  mirrored,   ///< Counter-clockwise; the angles increase nevertheless: a mirrored room.
  falling,    ///< Counter-clockwise; the angles decrease: receivers take such packets for suspect.
};

/// Settings and quality of the device. By default a G4 without errors.
struct scanner_options {
  std::uint64_t seed = 1;  ///< The seed of all random values below.
  wire_format format{};    ///< That of the model.
  std::uint16_t scan_frequency_chz =
      700;  ///< Revolutions per 100 s, constant; within those of the format.
  /// Selects one of the rates of the format: 4, 8 or 9 kHz of a G4.
  g4lidar::sample_rate sample_rate = g4lidar::sample_rate::khz_9;
  std::size_t samples_per_packet = 40;  ///< 1 to the most of the format, at most 80.
  double zero_deg = 0.0;   ///< By which the angles that it sends are too small, -360 to 360.
  double index_deg = 0.0;  ///< The angle of the index mark, [0, 360); 348 on some devices.
  /// The angle at the first sample, [0, 360); drawn at random where not given.
  std::optional<double> start_deg = std::nullopt;
  bool reports_frequency = true;  ///< Whether CT of a zero packet contains the scan frequency.
  double min_range_mm = 280.0;    ///< A nearer target gives no return.
  double max_range_mm =
      16'000.0;           ///< A farther target gives no return; at most what a sample can contain.
  double noise_mm = 0.0;  ///< Standard deviation of a range, >= 0, and its
  double noise_ratio = 0.0;  ///< increase per millimetre of range, >= 0.
  double dropout_ratio =
      0.0;  ///< The fraction of all samples without a return for no reason, 0 to 1.
  /// The true sample rate divided by the nominal one, 0.9 to 1.1, and its deviation to either side
  /// within a minute, 0 to 10000 millionths.
  double sample_rate_ratio = 1.0;
  double sample_rate_drift_ppm = 0.0;
  std::uint8_t ordinary_ct = 0;  ///< CT of packets that are not zero packets; its bit 0 is ignored.
  /// What CT of the packets 1 to 16 behind a zero packet contains in addition; see scanner_of().
  std::array<std::uint8_t, 16> information{};
};

/// What is wrong with `options`, a sentence for people; empty if nothing is. *Pure.*
[[nodiscard]] G4LIDAR_API std::string_view problem_with(const scanner_options& options) noexcept;

/// The true values of a sample, before it was rounded to the format of the protocol.
struct sample_truth {
  std::uint64_t index;   ///< Of the sample, from 0.
  std::int64_t time_ns;  ///< When it was measured; sample 0 at 0.
  /// From 0; one more with each zero packet except the first packet.
  std::uint64_t revolution;
  double first_level_deg;  ///< The angle of the head, clockwise, [0, 360).
  double
      bearing_deg;  ///< The direction of the target, clockwise, [0, 360); without a target, of an infinitely distant one.
  double range_mm;  ///< Of the target, at any distance and without noise; 0: there is none.
  /// As sent: in units of the format, of a G4 quarters of a millimetre; 0 for no return.
  std::uint16_t raw;
  std::uint16_t intensity;  ///< As sent; 0 if samples have none, and for no return.
  std::uint8_t flags;       ///< The same.
  pose lidar;               ///< The pose of the lidar at `time_ns`; its heading is not wrapped.
};

/// A packet as the device sends it, and the true values of its samples.
struct sent_packet {
  bytes data;                             ///< Valid until the next call of the scanner.
  std::span<const sample_truth> samples;  ///< The same number, in order; valid as long as `data`.
  std::int64_t complete_ns;  ///< When the last sample was measured: the packet is not sent before.
  /// Of the CT bytes of all packets since the last zero packet, without this one. Some models send it
  /// before a zero packet.
  std::uint8_t crc;
};

/// What a device sends first when scanning starts: the reply to the start command, 7 bytes. Valid
/// forever. (protocol: Commands, 60)
[[nodiscard]] G4LIDAR_API bytes scan_start_reply() noexcept;

/// A rotating head that measures in virtual time: each next() returns one packet. The same options
/// and world give the same bytes on every processor. *Single thread. Allocates on construction
/// only.* A copy is independent.
class G4LIDAR_API scanner {
 public:
  /// `problem_with(options)` must be empty; otherwise an assertion fails.
  scanner(const world& scene, const scanner_options& options);

  /// The next packet, without end. A zero packet when the index has passed, with the first sample
  /// after it; then packets of `samples_per_packet`, the last one of a revolution shorter.
  [[nodiscard]] sent_packet next() noexcept;

  /// From the next packet on the head makes this many turns per 1000 s, at most 20'000; at 0 it
  /// does not turn, and all samples have the same angle.
  void set_speed_mhz(std::uint32_t speed_mhz) noexcept;
  /// From the next packet on it has this sample rate.
  void set_sample_rate(sample_rate rate) noexcept;
  /// From the next packet on the head turns in this direction.
  void set_turning(turning way) noexcept { turning_ = way; }
  /// The next sample is measured at `at_ns`, not before the last one, when the head is `phase` /
  /// 2^64 turns after the index.
  void resume(std::int64_t at_ns, std::uint64_t phase) noexcept;
  /// When the next sample is measured, unless resume() changes it.
  [[nodiscard]] std::int64_t next_sample_ns() const noexcept;

  /// As given, except `sample_rate`, which set_sample_rate() changes; valid as long as the scanner.
  [[nodiscard]] const scanner_options& options() const noexcept { return options_; }

 private:
  [[nodiscard]] sample_truth measure() noexcept;
  [[nodiscard]] std::uint16_t raw_sample(double range_mm) noexcept;
  void turn_on() noexcept;
  [[nodiscard]] std::uint8_t next_ct(bool zero) noexcept;
  void keep_rate() noexcept;
  void set_step() noexcept;

  scanner_options options_;
  scene_caster caster_;
  random_stream noise_;
  random_stream dropouts_;
  turning turning_ = turning::clockwise;
  std::uint32_t speed_mhz_;
  std::uint64_t rate_mhz_;        // the true one, in 0.001 Hz
  std::int64_t since_ns_ = 0;     // the time since which that rate is valid,
  std::uint64_t index_then_ = 0;  // and the sample that was measured then
  std::uint64_t phase_;           // since the index, in 2^-64 of a turn
  std::uint64_t step_;            // of a sample
  std::uint64_t index_ = 0;
  std::uint64_t revolution_ = 0;
  bool at_index_;  // the index has passed since the last sample
  std::uint8_t crc_ = 0;
  std::size_t since_zero_ = scanner_options{}.information.size();  // packets; more do not matter
  std::array<sample_truth, most_samples> truths_{};
  std::array<std::uint8_t, longest_packet> packet_{};
};

}  // namespace g4lidar::sim
